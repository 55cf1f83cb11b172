#include "formats/measurement/table_header.h"

#include <algorithm>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/measurement/column_name.h"

namespace palpate {
namespace {

using Cells = std::vector<std::string>;

constexpr std::size_t kUnitLength = 8;  // bytes: "mm/min", "N/mm2", "(MPa)"

bool is_mass(const std::string& unit) {
  return unit == "g" || unit == "kg";  // a force beside a force's name
}

// Units alone: all known, or two known and others that are short.
bool are_units(const Cells& cells) {
  std::size_t known = 0, empty = 0, brief = 0;
  for (const std::string& cell : cells) {
    const std::string unit = stated_unit(cell);
    known += is_known_unit(unit) || is_mass(unit) ? 1 : 0;
    empty += cell.empty() ? 1 : 0;
    brief += cell.size() <= kUnitLength ? 1 : 0;
  }
  return known > 0 &&
         (known + empty == cells.size() || (known > 1 && brief == cells.size()));
}

// Units of the columns, from their names, else from a line of units below these.
Cells units_of(const Cells& names, const Cells& below) {
  Cells units;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const ColumnName name = parse_column_name(names[i]);
    units.push_back(name.unit.empty() && i < below.size()
                        ? unit_beside(name.quantity, stated_unit(below[i]))
                        : name.unit);
  }
  return units;
}

std::string only_one(const std::string& file, const TableHeader& header,
                     std::size_t which) {
  const std::vector<std::size_t> found = columns_with_unit(header, which);
  if (found.size() == 1) {
    return chosen_by(header, found.front());
  }
  std::string named;
  for (const std::size_t i : found) {
    named += fmt::format("{}\"{}\" (column {})", named.empty() ? "" : ", ",
                         header.name[i], i + 1);
  }
  std::string all;
  for (const std::string& name : header.name) {
    all += fmt::format("{}\"{}\"", all.empty() ? "" : ", ", name);
  }
  throw InputError(
      found.empty()
          ? fmt::format("{}: no column of the header states a unit of {}; columns "
                        "found: {}; tell which is the {}, and its unit",
                        file, which == kDepth ? "length" : "force", all,
                        kQuantityNames[which])
          : fmt::format("{}: {} columns may be the {}: {}; tell which", file,
                        found.size(), kQuantityNames[which], named));
}

// A line with a cell such as "1,234.5"; 0: none.
std::size_t line_with_thousands(std::span<const TextLine> lines) {
  for (const TextLine& line : lines) {
    for (const std::string& cell : split_cells(line.text, ',')) {
      if (ends_in_groups(cell.substr(0, cell.find('.')), ',')) {
        return line.number;
      }
    }
  }
  return 0;
}

}  // namespace

std::string stated_unit(const std::string& cell) {
  const std::string unit = parse_column_name(cell).unit;
  return unit.empty() ? cell : unit;
}

bool is_number_row(const TextLine& line, char delimiter) {
  const Cells cells = split_cells(line.text, delimiter);
  std::size_t numbers = 0;
  for (std::size_t i = 0; i < cells.size() && numbers < 2; ++i) {
    numbers += parse_number(cells[i], delimiter != ',').has_value() ? 1 : 0;
  }
  return numbers > 1;
}

std::optional<TableHeader> find_header(std::span<const TextLine> lines, char delimiter,
                                       std::size_t begin) {
  std::size_t row = begin;
  while (row < lines.size() && !is_number_row(lines[row], delimiter)) {
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
  for (const char delimiter : {'\t', ';', ','}) {
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
  return found;
}

std::string chosen_by(const TableHeader& header, std::size_t column) {
  const std::string& name = header.name[column];
  const bool named = !name.empty() && !column_number(name) &&
                     matching_columns(header.name, name).size() == 1;
  return named ? name : std::to_string(column + 1);
}

MeasurementColumns columns_of_lines(const std::string& file,
                                    std::span<const TextLine> lines,
                                    const MeasurementColumns& told) {
  MeasurementColumns columns = told;
  std::optional<TableHeader> header;
  if (told.depth.column.empty() || told.force.column.empty()) {
    header = find_header(lines);
    const std::size_t thousands = header ? 0 : line_with_thousands(lines);
    if (thousands > 0) {
      throw InputError(fmt::format(
          "{}: no row of numbers: line {} separates thousands by commas, and thousands "
          "separators are not read; export without them",
          file, thousands));
    }
    if (!header) {
      throw InputError(fmt::format(
          "{}: no line of names above the first row of numbers; tell depth and force "
          "column by number, from 1, and their units",
          file));
    }
  }
  MeasurementColumn* asked[] = {&columns.depth, &columns.force};
  for (std::size_t which = 0; which < std::size(asked); ++which) {
    MeasurementColumn& column = *asked[which];
    if (column.column.empty()) {
      column.column = only_one(file, *header, which);
    }
    if (column.unit.empty()) {
      column.unit = kUnitFromHeader;
    }
  }
  return columns;
}

}  // namespace palpate
