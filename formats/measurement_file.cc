#include "formats/measurement_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "formats/column_name.h"
#include "formats/delimited_text.h"
#include "formats/error.h"
#include "formats/units.h"

namespace palpate {
namespace {

using Cells = std::vector<std::string>;

struct Table {
  char delimiter = ',';
  Cells header;             // empty where the file has none
  std::size_t begin = 0;    // first line below the header
  std::size_t column[2]{};  // depth, force
};

struct Request {
  std::string file;  // for messages
  const MeasurementColumn* column[2];
  HeaderUnits header_units;
};

constexpr const char* kQuantity[] = {"depth", "force"};

// The column's number counted from 1, where the choice is one.
std::optional<std::size_t> column_number(const MeasurementColumn& choice) {
  std::size_t number = 0;
  const char* end = choice.column.data() + choice.column.size();
  const auto [stop, error] = std::from_chars(choice.column.data(), end, number);
  if (error != std::errc() || stop != end) {
    return std::nullopt;
  }
  return number;
}

bool numeric(const Cells& cells, std::size_t column, char delimiter) {
  return column < cells.size() &&
         parse_number(cells[column], delimiter != ',').has_value();
}

// The line before the first one with two numbers or more, where it has as many cells.
std::optional<Table> first_numbers(std::span<const TextLine> lines, char delimiter) {
  Cells before;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Cells cells = split_cells(lines[i].text, delimiter);
    const auto numbers =
        std::count_if(cells.begin(), cells.end(), [&](const std::string& cell) {
          return parse_number(cell, delimiter != ',').has_value();
        });
    if (numbers >= 2) {
      const bool named = before.size() == cells.size();
      return Table{delimiter, named ? before : Cells{}, i, {}};
    }
    before = cells;
  }
  return std::nullopt;
}

std::optional<std::size_t> resolve(const Request& request, int which,
                                   const Cells& header) {
  const MeasurementColumn& choice = *request.column[which];
  if (const auto number = column_number(choice)) {
    return *number - 1;
  }
  const std::vector<std::size_t> matches = matching_columns(header, choice.column);
  if (matches.size() > 1) {
    throw InputError(fmt::format(
        "{}: {} column \"{}\" may be any of {} columns; choose one by its number",
        request.file, kQuantity[which], choice.column, matches.size()));
  }
  return matches.empty() ? std::nullopt : std::optional(matches[0]);
}

// Both columns by number: the first line in which both are numbers begins the data.
std::optional<Table> find_by_numbers(const Request& request,
                                     std::span<const TextLine> lines, char delimiter) {
  const std::size_t column[] = {*column_number(*request.column[0]) - 1,
                                *column_number(*request.column[1]) - 1};
  Cells before;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Cells cells = split_cells(lines[i].text, delimiter);
    if (numeric(cells, column[0], delimiter) && numeric(cells, column[1], delimiter)) {
      const bool named = before.size() == cells.size();
      return Table{delimiter, named ? before : Cells{}, i, {column[0], column[1]}};
    }
    before = cells;
  }
  return std::nullopt;
}

// A column by name: the first line that holds the name begins the table.
std::optional<Table> find_by_names(const Request& request,
                                   std::span<const TextLine> lines, char delimiter) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Cells cells = split_cells(lines[i].text, delimiter);
    if (cells.size() < 2) {
      continue;
    }
    const auto depth = resolve(request, 0, cells);
    const auto force = resolve(request, 1, cells);
    if (depth && force) {
      return Table{delimiter, cells, i + 1, {*depth, *force}};
    }
  }
  return std::nullopt;
}

[[noreturn]] void refuse_columns(const Request& request,
                                 std::span<const TextLine> lines) {
  for (const char delimiter : {'\t', ';', ','}) {
    const auto table = first_numbers(lines, delimiter);
    if (!table) {
      continue;
    }
    for (int which = 0; which < 2; ++which) {
      const std::string& name = request.column[which]->column;
      const bool number = column_number(*request.column[which]).has_value();
      if (!number && !resolve(request, which, table->header)) {
        throw InputError(fmt::format("{}: no {} column \"{}\"; columns found: {}",
                                     request.file, kQuantity[which], name,
                                     table->header.empty()
                                         ? "none has a name; choose by number, from 1"
                                         : nearest_columns(table->header, name)));
      }
    }
    throw InputError(fmt::format(
        "{}: columns {} and {} hold no row of numbers; line {} has {} columns",
        request.file, request.column[0]->column, request.column[1]->column,
        lines[table->begin].number,
        split_cells(lines[table->begin].text, delimiter).size()));
  }
  throw InputError(fmt::format(
      "{}: no row with two numbers or more, separated by comma, semicolon or tab",
      request.file));
}

Table find_table(const Request& request, std::span<const TextLine> lines) {
  const bool numbers =
      column_number(*request.column[0]) && column_number(*request.column[1]);
  for (const char delimiter : {'\t', ';', ','}) {
    const auto table = numbers ? find_by_numbers(request, lines, delimiter)
                               : find_by_names(request, lines, delimiter);
    if (table) {
      return *table;
    }
  }
  refuse_columns(request, lines);
}

// A stated unit of the other kind or of another size is a contradiction; a text that
// is no known unit says nothing.
void check_unit(const Request& request, int which, const std::string& stated,
                std::string_view where) {
  if (request.header_units == HeaderUnits::kIgnored) {
    return;
  }
  const std::string& asked = request.column[which]->unit;
  const auto length = length_unit_si(stated);
  const auto force = force_unit_si(stated);
  const auto same_kind = which == 0 ? length : force;
  const double size = which == 0 ? metres_per(asked) : newtons_per(asked);
  if ((length || force) && same_kind != size) {
    throw InputError(
        fmt::format("{}: {} states the unit {}, but the {} unit is given "
                    "as {}",
                    request.file, where, stated, kQuantity[which], asked));
  }
}

// The line below the header, if it holds units; both cells are no numbers then.
bool is_unit_line(const Request& request, const Table& table, const TextLine& line) {
  const Cells cells = split_cells(line.text, table.delimiter);
  for (const std::size_t column : table.column) {
    if (column >= cells.size() || numeric(cells, column, table.delimiter) ||
        cells[column].empty()) {
      return false;
    }
  }
  for (int which = 0; which < 2; ++which) {
    const std::string& cell = cells[table.column[which]];
    const std::string unit = parse_column_name(cell).unit;
    const std::string stated = unit.empty() ? cell : unit;
    if (!length_unit_si(stated) && !force_unit_si(stated)) {
      return false;
    }
    check_unit(request, which, stated, fmt::format("line {}", line.number));
  }
  return true;
}

double cell_number(const Request& request, const Table& table, const TextLine& line,
                   const Cells& cells, int which) {
  const std::size_t column = table.column[which];
  const std::string name =
      column < table.header.size() ? fmt::format(" \"{}\"", table.header[column]) : "";
  if (column >= cells.size()) {
    throw FormatError(fmt::format("{}: line {} has {} cells, column {}{} is missing",
                                  request.file, line.number, cells.size(), column + 1,
                                  name));
  }
  const auto value = parse_number(cells[column], table.delimiter != ',');
  if (!value || !std::isfinite(*value)) {
    throw FormatError(
        fmt::format("{}: line {}, column {}{}: \"{}\" is not a finite "
                    "number",
                    request.file, line.number, column + 1, name, cells[column]));
  }
  return *value;
}

bool both_empty(const Table& table, const Cells& cells) {
  return std::all_of(std::begin(table.column), std::end(table.column),
                     [&](std::size_t column) {
                       return column < cells.size() && cells[column].empty();
                     });
}

}  // namespace

MeasurementFile read_measurement(const std::filesystem::path& file,
                                 const MeasurementColumn& depth,
                                 const MeasurementColumn& force,
                                 HeaderUnits header_units) {
  const double metres = metres_per(depth.unit);
  const double newtons = newtons_per(force.unit);
  const Request request{file.string(), {&depth, &force}, header_units};
  for (int which = 0; which < 2; ++which) {
    if (column_number(*request.column[which]) == std::size_t{0}) {
      throw InputError(
          fmt::format("{} column 0: columns are counted from 1", kQuantity[which]));
    }
  }
  const std::vector<TextLine> lines = read_text_lines(file);
  const Table table = find_table(request, lines);

  MeasurementFile result;
  std::string* name[] = {&result.depth_column, &result.force_column};
  for (int which = 0; which < 2; ++which) {
    if (table.column[which] < table.header.size()) {
      *name[which] = table.header[table.column[which]];
      check_unit(request, which, parse_column_name(*name[which]).unit,
                 fmt::format("column \"{}\"", *name[which]));
    }
  }
  for (std::size_t i = table.begin; i < lines.size(); ++i) {
    const Cells cells = split_cells(lines[i].text, table.delimiter);
    if (both_empty(table, cells) ||
        (i == table.begin && is_unit_line(request, table, lines[i]))) {
      continue;
    }
    const double x = cell_number(request, table, lines[i], cells, 0);
    const double f = cell_number(request, table, lines[i], cells, 1);
    result.samples.depth_m.push_back(x * metres);
    result.samples.force_n.push_back(f * newtons);
  }
  if (result.samples.depth_m.empty()) {
    throw InputError(
        fmt::format("{}: no rows of numbers below the header", request.file));
  }
  return result;
}

}  // namespace palpate
