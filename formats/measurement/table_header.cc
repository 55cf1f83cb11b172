#include "formats/measurement/table_header.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

#include "formats/measurement/column_name.h"

namespace palpate {
namespace {

using Cells = std::vector<std::string>;

constexpr std::size_t kUnitLength = 8;  // bytes: "mm/min", "N/mm2", "(MPa)"

bool is_mass(const std::string& unit) {
  return unit == "g" || unit == "kg";  // a force beside a force's name
}

// "F_std", "Load SD", "error": how sure another column is.
bool is_spread(std::string_view name) {
  std::string word;
  const auto has_units = [&] {
    return word == "std" || word == "sd" || word == "stdev" || word == "stddev" ||
           word == "error" || word == "err" || word == "sem" || word == "sigma" ||
           word == "deviation" || word == "uncertainty";
  };
  for (const char c : name) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (has_units()) {
      return true;
    } else {
      word.clear();
    }
  }
  return has_units();
}

// Units alone: all known, or two known and others that are short. Numbers beside them
// belong to somebody's calculations in the same sheet.
bool are_units(const Cells& cells) {
  std::size_t known = 0, others = 0, brief = 0;
  for (const std::string& cell : cells) {
    const std::string unit = stated_unit(cell);
    const bool beside = cell.empty() || parse_number(cell, true).has_value();
    known += is_known_unit(unit) || is_mass(unit) ? 1 : 0;
    others += beside ? 1 : 0;
    brief += beside || cell.size() <= kUnitLength ? 1 : 0;
  }
  return known > 0 &&
         (known + others == cells.size() || (known > 1 && brief == cells.size()));
}

bool is_no_number(const std::string& cell) {  // quick: most cells are numbers
  return !cell.empty() && std::string_view("+-.,0123456789").find(cell.front()) ==
                              std::string_view::npos;
}

// "mm", "(mm)" or "Travel (mm)".
bool states_a_unit(const std::string& cell) {
  return is_no_number(cell) && is_known_unit(stated_unit(cell));
}

// "mm" or "(mm)".
bool is_a_unit(const std::string& cell) {
  const bool bare = !cell.empty() && (cell.front() == '(' || cell.front() == '[' ||
                                      stated_unit(cell) == cell);
  return bare && states_a_unit(cell);
}

// Two cells or more are units, whatever stands beside them.
bool holds_units(const TextLine& line, char delimiter) {
  const Cells cells = split_cells(line.text, delimiter);
  return std::count_if(cells.begin(), cells.end(), &is_a_unit) > 1;
}

// Units of the columns, from their names, else from a line of units below these.
Cells units_of(const Cells& names, const Cells& below) {
  Cells units;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const ColumnName name = parse_column_name(names[i]);
    const bool bare = name.unit.empty() && below.empty() && is_known_unit(names[i]);
    units.push_back(bare ? names[i]
                    : name.unit.empty() && i < below.size()
                        ? unit_beside(name.quantity, stated_unit(below[i]))
                        : name.unit);
  }
  return units;
}

}  // namespace

std::string stated_unit(const std::string& cell) {
  const std::string unit = parse_column_name(cell).unit;
  return unit.empty() ? cell : unit;
}

bool is_number_row(std::span<const TextLine> lines, std::size_t row, char delimiter) {
  std::size_t numbers = 0, units = 0;
  for (const std::string& cell : split_cells(lines[row].text, delimiter)) {
    numbers += parse_number(cell, true).has_value() ? 1 : 0;
    units += states_a_unit(cell) ? 1 : 0;
  }
  return numbers > 1 && units < 2 &&
         !(row + 1 < lines.size() && holds_units(lines[row + 1], delimiter));
}

std::optional<TableHeader> find_header(std::span<const TextLine> lines, char delimiter,
                                       std::size_t begin) {
  std::size_t row = begin;
  while (row < lines.size() && !is_number_row(lines, row, delimiter)) {
    ++row;
  }
  if (row == lines.size()) {
    return std::nullopt;
  }
  TableHeader header{delimiter, row, row, {}, {}};
  const auto cells_above = [&](std::size_t up) {
    return row >= begin + up ? split_cells(lines[row - up].text, delimiter) : Cells{};
  };
  const std::size_t count = split_cells(lines[row].text, delimiter).size();
  const Cells last = cells_above(1), before = cells_above(2);
  if (last.size() != count) {
    return header;
  }
  const bool unit_line = before.size() == count && are_units(last);
  header.name = unit_line ? before : last;
  header.unit = units_of(header.name, unit_line ? last : Cells{});
  header.names = row - (unit_line ? 2 : 1);
  return header;
}

std::optional<TableHeader> find_header(std::span<const TextLine> lines) {
  for (const char delimiter : kDelimiters) {
    auto header = find_header(lines, delimiter);
    if (header && !header->name.empty()) {
      return header;
    }
  }
  return std::nullopt;
}

std::vector<std::size_t> columns_with_unit(const TableHeader& header,
                                           std::size_t quantity) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < header.unit.size(); ++i) {
    if (unit_si(quantity, header.unit[i])) {
      found.push_back(i);
    }
  }
  const auto spread = [&](std::size_t column) {
    return is_spread(parse_column_name(header.name[column]).quantity);
  };
  if (!std::all_of(found.begin(), found.end(), spread)) {
    std::erase_if(found, spread);
  }
  return found;
}

std::string chosen_by(const TableHeader& header, std::size_t column) {
  const std::string& name = header.name[column];
  const bool named = !name.empty() && !column_number(name) &&
                     matching_columns(header.name, name).size() == 1;
  return named ? name : std::to_string(column + 1);
}

}  // namespace palpate
