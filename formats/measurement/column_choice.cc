#include "formats/measurement/column_choice.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/measurement/column_name.h"
#include "formats/measurement/lateral_choice.h"
#include "formats/measurement/table_header.h"

namespace palpate {
namespace {

using Numbers = std::vector<double>;

constexpr double kSame = 1e-3;    // [-] of a column's range, by which two may differ
constexpr double kSmooth = 1.02;  // [-] way of the values over the shortest
constexpr std::size_t kGlitchesOneOf = 50;  // rows: a single reading may be wild

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

TableHeader header_of(const std::string& file, std::span<const TextLine> lines) {
  const std::optional<TableHeader> header = find_header(lines);
  if (header) {
    return *header;
  }
  if (const std::size_t thousands = line_with_thousands(lines); thousands > 0) {
    throw InputError(fmt::format(
        "{}: no row of numbers: line {} separates thousands by commas, and thousands "
        "separators are not read; export without them",
        file, thousands));
  }
  const bool rows = std::any_of(kDelimiters.begin(), kDelimiters.end(), [&](char mark) {
    return find_header(lines, mark).has_value();
  });
  if (!rows) {
    throw FormatError(
        lines.empty()
            ? fmt::format("{}: is empty", file)
            : fmt::format("{}: no line of names above a row of two numbers or more; "
                          "columns are separated by comma, semicolon, tab or blanks",
                          file));
  }
  throw InputError(
      fmt::format("{}: no line of names above the first row of numbers; tell depth and "
                  "force column by number, from 1, and their units",
                  file));
}

// Columns in SI units, of the rows in which all of them are numbers.
std::vector<Numbers> numbers_in(std::span<const TextLine> lines,
                                const TableHeader& header,
                                const std::vector<std::size_t>& columns,
                                std::size_t quantity) {
  std::vector<Numbers> numbers(columns.size());
  for (const TextLine& line : lines.subspan(header.begin)) {
    const auto cells = split_cells(line.text, header.delimiter);
    std::vector<double> row;
    for (const std::size_t column : columns) {
      const auto value =
          column < cells.size() ? parse_number(cells[column], true) : std::nullopt;
      if (!value || !std::isfinite(*value)) {
        break;
      }
      row.push_back(*value * unit_si(quantity, header.unit[column]).value());
    }
    for (std::size_t i = 0; row.size() == columns.size() && i < row.size(); ++i) {
      numbers[i].push_back(row[i]);
    }
  }
  return numbers;
}

// Rows in which the values are farther from their median than `reach`.
std::size_t rows_apart(const Numbers& values, double reach) {
  Numbers sorted = values;
  const auto middle = sorted.begin() + std::ssize(sorted) / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  return static_cast<std::size_t>(
      std::count_if(values.begin(), values.end(), [&](double value) {
        return !(std::abs(value - *middle) <= reach);
      }));
}

// Whether b = a + constant, or b = -a + constant, but for glitches.
bool tell_the_same(const Numbers& a, const Numbers& b) {
  Numbers sum(a.size()), difference(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum[i] = a[i] + b[i];
    difference[i] = a[i] - b[i];
  }
  const auto [low, high] = std::minmax_element(a.begin(), a.end());
  const double reach = kSame * (*high - *low);
  return reach > 0.0 &&
         std::min(rows_apart(sum, reach), rows_apart(difference, reach)) <=
             a.size() / kGlitchesOneOf;
}

// The way that the values go in all, which a glitch makes longer.
double way(const Numbers& values) {
  double sum = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    sum += std::abs(values[i] - values[i - 1]);
  }
  return sum;
}

bool moves_upwards(const Numbers& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - values.front() >= values.front() - *low;
}

// One of several columns that tell the same; none where they do not.
std::optional<std::size_t> one_of_twins(std::span<const TextLine> lines,
                                        const TableHeader& header,
                                        const std::vector<std::size_t>& columns,
                                        std::size_t quantity) {
  const auto numbers = numbers_in(lines, header, columns, quantity);
  const Numbers& first = numbers.front();
  if (first.size() < 2 ||
      !std::all_of(numbers.begin() + 1, numbers.end(), [&](const Numbers& other) {
        return tell_the_same(first, other);
      })) {
    return std::nullopt;
  }
  // A column with glitches goes a longer way. Of the smooth ones, one that moves
  // upwards is taken before one that moves down.
  double shortest = way(first);
  for (const Numbers& column : numbers) {
    shortest = std::min(shortest, way(column));
  }
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const bool smooth = way(numbers[i]) <= kSmooth * shortest;
    if (smooth &&
        (!best || (!moves_upwards(numbers[*best]) && moves_upwards(numbers[i])))) {
      best = i;
    }
  }
  return columns[best.value()];
}

std::string listed(const TableHeader& header, const std::vector<std::size_t>& columns) {
  std::string text;
  for (const std::size_t i : columns) {
    text += fmt::format("{}\"{}\" (column {})", text.empty() ? "" : ", ",
                        header.name[i], i + 1);
  }
  return text;
}

std::string all_names(const TableHeader& header) {
  std::string all;
  for (const std::string& name : header.name) {
    all += name.empty() ? "" : fmt::format("{}\"{}\"", all.empty() ? "" : ", ", name);
  }
  return all;
}

// "Mass (g)" or "Specimen (g)" is what was weighed, no force.
bool is_weighed(const std::string& name) {
  std::string lower = name;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return lower.find("mass") != std::string::npos ||
         lower.find("specimen") != std::string::npos ||
         lower.find("sample") != std::string::npos;
}

// Where nothing states a force, but one column a mass, that is one: what a scale shows.
std::optional<MeasurementColumn> only_mass(const TableHeader& header) {
  std::optional<MeasurementColumn> mass;
  for (std::size_t i = 0; i < header.unit.size(); ++i) {
    const std::string unit = unit_beside("force", header.unit[i]);
    if (!header.unit[i].empty() && unit != header.unit[i] &&
        !is_weighed(header.name[i])) {
      if (mass) {
        return std::nullopt;
      }
      mass = MeasurementColumn{chosen_by(header, i), unit};
    }
  }
  return mass;
}

// Two lengths and no force: what an AFM writes before it is calibrated.
void refuse_deflection(const std::string& file, const TableHeader& header) {
  const auto lengths = columns_with_unit(header, kDepth);
  if (lengths.size() == 2 && columns_with_unit(header, kForce).empty() &&
      !only_mass(header)) {
    throw InputError(fmt::format(
        "{}: {} are lengths, and none is a force: where one is the deflection of a "
        "cantilever, export the force (deflection times spring constant, N/m) beside "
        "them, or tell which column is the force, and its unit",
        file, listed(header, lengths)));
  }
}

std::string only_one(const std::string& file, std::span<const TextLine> lines,
                     const TableHeader& header, std::size_t which,
                     std::vector<std::string>* notes) {
  std::vector<std::size_t> found = columns_with_unit(header, which);
  if (found.empty()) {
    throw InputError(
        fmt::format("{}: no column of the header states a unit of {}; columns found: "
                    "{}; tell which is the {}, and its unit",
                    file, which == kDepth ? "length" : "force", all_names(header),
                    kQuantityNames[which]));
  }
  if (found.size() > 1) {
    const auto one = one_of_twins(lines, header, found, which);
    if (!one) {
      throw InputError(fmt::format("{}: {} columns may be the {}: {}; tell which", file,
                                   found.size(), kQuantityNames[which],
                                   listed(header, found)));
    }
    std::erase(found, *one);
    if (notes != nullptr) {
      notes->push_back(fmt::format(
          "\"{}\" is the {}: {} tell{} the same", header.name[*one],
          kQuantityNames[which], listed(header, found), found.size() == 1 ? "s" : ""));
    }
    return chosen_by(header, *one);
  }
  return chosen_by(header, found.front());
}

}  // namespace

MeasurementColumns columns_of_lines(const std::string& file,
                                    std::span<const TextLine> lines,
                                    const MeasurementColumns& given,
                                    std::vector<std::string>* notes) {
  MeasurementColumns columns = given;
  std::optional<TableHeader> header;
  if (given.depth.column.empty() || given.force.column.empty()) {
    header = header_of(file, lines);
  } else if (given.lateral) {
    header = find_header(lines);  // may tell the normal force
  }
  if (given.lateral && header) {
    take_lateral_columns(file, *header, columns, notes);
  }
  if (columns.depth.column.empty() && columns.force.column.empty()) {
    refuse_deflection(file, *header);
  }
  if (header && !given.time && notes != nullptr) {
    if (const auto times = columns_with_unit(*header, kTime); times.size() > 1) {
      notes->push_back(fmt::format("{} are times: none is taken; tell which",
                                   listed(*header, times)));
    }
  }
  MeasurementColumn* asked[] = {&columns.depth, &columns.force};
  for (std::size_t which = 0; which < std::size(asked); ++which) {
    MeasurementColumn& column = *asked[which];
    if (column.column.empty() && which == kForce && column.unit.empty() &&
        columns_with_unit(*header, kForce).empty()) {
      if (const auto mass = only_mass(*header)) {
        column = *mass;
        if (notes != nullptr) {
          notes->push_back(
              fmt::format("\"{}\" is the force, in {}: no other column is one",
                          column.column, column.unit));
        }
        continue;
      }
    }
    if (column.column.empty()) {
      column.column = only_one(file, lines, *header, which, notes);
    }
    if (column.unit.empty()) {
      column.unit = kUnitFromHeader;
    }
  }
  return columns;
}

}  // namespace palpate
