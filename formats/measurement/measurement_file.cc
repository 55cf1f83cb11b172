#include "formats/measurement/measurement_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/units.h"
#include "formats/measurement/column_name.h"
#include "formats/measurement/delimited_text.h"

namespace palpate {
namespace {

using Cells = std::vector<std::string>;

struct Table {
  char delimiter = ',';
  Cells header;                     // empty where the file has none
  std::size_t begin = 0;            // first line below the header
  std::vector<std::size_t> column;  // depth, force, and time where it is asked for
};

struct Request {
  std::string file;  // for messages
  std::vector<const MeasurementColumn*> column;
  HeaderUnits header_units;
};

constexpr const char* kQuantity[] = {"depth", "force", "time"};
constexpr double (*kUnitSize[])(std::string_view) = {metres_per, newtons_per,
                                                     seconds_per};

std::optional<double> unit_si(std::size_t which, const std::string& unit) {
  return which == 0   ? length_unit_si(unit)
         : which == 1 ? force_unit_si(unit)
                      : time_unit_si(unit);
}

bool is_unit(const std::string& text) {
  return length_unit_si(text) || force_unit_si(text) || time_unit_si(text);
}

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

std::optional<std::size_t> resolve(const Request& request, std::size_t which,
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

// All columns by number: the first line in which all are numbers begins the data.
std::optional<Table> find_by_numbers(const Request& request,
                                     std::span<const TextLine> lines, char delimiter) {
  std::vector<std::size_t> column;
  for (const MeasurementColumn* choice : request.column) {
    column.push_back(*column_number(*choice) - 1);
  }
  Cells before;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Cells cells = split_cells(lines[i].text, delimiter);
    if (std::all_of(column.begin(), column.end(), [&](std::size_t which) {
          return numeric(cells, which, delimiter);
        })) {
      const bool named = before.size() == cells.size();
      return Table{delimiter, named ? before : Cells{}, i, column};
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
    std::vector<std::size_t> column;
    for (std::size_t which = 0; which < request.column.size(); ++which) {
      if (const auto found = resolve(request, which, cells)) {
        column.push_back(*found);
      }
    }
    if (column.size() == request.column.size()) {
      return Table{delimiter, cells, i + 1, column};
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
    for (std::size_t which = 0; which < request.column.size(); ++which) {
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
  const bool numbers = std::all_of(request.column.begin(), request.column.end(),
                                   [](const MeasurementColumn* choice) {
                                     return column_number(*choice).has_value();
                                   });
  for (const char delimiter : {'\t', ';', ','}) {
    const auto table = numbers ? find_by_numbers(request, lines, delimiter)
                               : find_by_names(request, lines, delimiter);
    if (table) {
      return *table;
    }
  }
  refuse_columns(request, lines);
}

// A stated unit of another kind or of another size is a contradiction; a text that
// is no known unit says nothing.
void check_unit(const Request& request, std::size_t which, const std::string& stated,
                std::string_view where) {
  const std::string& asked = request.column[which]->unit;
  if (request.header_units == HeaderUnits::kIgnored || asked == kUnitFromHeader) {
    return;
  }
  if (is_unit(stated) && unit_si(which, stated) != kUnitSize[which](asked)) {
    throw InputError(
        fmt::format("{}: {} states the unit {}, but the {} unit is given "
                    "as {}",
                    request.file, where, stated, kQuantity[which], asked));
  }
}

std::string stated_in(const std::string& cell) {
  const std::string unit = parse_column_name(cell).unit;
  return unit.empty() ? cell : unit;
}

// The line below the header, if it holds units; no cell is a number then.
bool is_unit_line(const Request& request, const Table& table, const TextLine& line) {
  const Cells cells = split_cells(line.text, table.delimiter);
  for (const std::size_t column : table.column) {
    if (column >= cells.size() || numeric(cells, column, table.delimiter) ||
        !is_unit(stated_in(cells[column]))) {
      return false;
    }
  }
  for (std::size_t which = 0; which < table.column.size(); ++which) {
    check_unit(request, which, stated_in(cells[table.column[which]]),
               fmt::format("line {}", line.number));
  }
  return true;
}

// SI units in one of the column's: as it was given, or as header or unit line state it.
double unit_size(const Request& request, const Table& table, std::size_t which,
                 const std::optional<TextLine>& unit_line) {
  if (request.column[which]->unit != kUnitFromHeader) {
    return kUnitSize[which](request.column[which]->unit);
  }
  const std::size_t column = table.column[which];
  std::string stated;
  if (unit_line) {
    stated = stated_in(split_cells(unit_line->text, table.delimiter)[column]);
  } else if (column < table.header.size()) {
    stated = parse_column_name(table.header[column]).unit;
  }
  const auto size = unit_si(which, stated);
  if (!size) {
    throw InputError(fmt::format(
        "{}: the {} unit is to be read from the header, which states {}", request.file,
        kQuantity[which], stated.empty() ? "none" : fmt::format("{:?}", stated)));
  }
  return *size;
}

double cell_number(const Request& request, const Table& table, const TextLine& line,
                   const Cells& cells, std::size_t which) {
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

bool all_empty(const Table& table, const Cells& cells) {
  return std::all_of(table.column.begin(), table.column.end(), [&](std::size_t column) {
    return column < cells.size() && cells[column].empty();
  });
}

// Units of the columns, from their names, else from a line of units below these.
Cells units_of(const Cells& names, const Cells& below) {
  Cells units;
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string unit = parse_column_name(names[i]).unit;
    if (unit.empty() && i < below.size()) {
      unit = stated_in(below[i]);
    }
    units.push_back(std::move(unit));
  }
  return units;
}

// The table's names and units: those above its first row of numbers.
struct NamesAndUnits {
  Cells name, unit;
};

std::optional<NamesAndUnits> names_and_units(std::span<const TextLine> lines,
                                             char delimiter) {
  const auto table = first_numbers(lines, delimiter);
  if (!table || table->header.empty()) {
    return std::nullopt;
  }
  const Cells& last = table->header;
  const bool are_units = std::all_of(last.begin(), last.end(), [](const auto& cell) {
    return cell.empty() || is_unit(stated_in(cell));
  });
  if (are_units && table->begin > 1) {
    Cells names = split_cells(lines[table->begin - 2].text, delimiter);
    if (names.size() == last.size()) {
      return NamesAndUnits{names, units_of(names, last)};
    }
  }
  return NamesAndUnits{last, units_of(last, {})};
}

std::optional<NamesAndUnits> header_of(std::span<const TextLine> lines) {
  for (const char delimiter : {'\t', ';', ','}) {
    if (auto header = names_and_units(lines, delimiter)) {
      return header;
    }
  }
  return std::nullopt;
}

// By its name, or by its number where others have the same.
std::string chosen_by(const NamesAndUnits& header, std::size_t column) {
  const std::string& name = header.name[column];
  const bool named = !name.empty() && !column_number({name, ""}) &&
                     matching_columns(header.name, name).size() == 1;
  return named ? name : std::to_string(column + 1);
}

std::string only_one(const std::string& file, const NamesAndUnits& header,
                     std::size_t which) {
  std::vector<std::size_t> found;
  std::string named;
  for (std::size_t i = 0; i < header.name.size(); ++i) {
    if (unit_si(which, header.unit[i])) {
      found.push_back(i);
      named += fmt::format("{}\"{}\" (column {})", named.empty() ? "" : ", ",
                           header.name[i], i + 1);
    }
  }
  if (found.size() == 1) {
    return chosen_by(header, found.front());
  }
  std::string all;
  for (const std::string& name : header.name) {
    all += fmt::format("{}\"{}\"", all.empty() ? "" : ", ", name);
  }
  throw InputError(
      found.empty()
          ? fmt::format("{}: no column of the header states a unit of {}; columns "
                        "found: {}; tell which is the {}, and its unit",
                        file, which == 0 ? "length" : "force", all, kQuantity[which])
          : fmt::format("{}: {} columns may be the {}: {}; tell which", file,
                        found.size(), kQuantity[which], named));
}

Request make_request(const std::filesystem::path& file,
                     const MeasurementColumns& columns, HeaderUnits header_units) {
  Request request{file.string(), {&columns.depth, &columns.force}, header_units};
  if (columns.time) {
    request.column.push_back(&*columns.time);
  }
  for (std::size_t which = 0; which < request.column.size(); ++which) {
    if (request.column[which]->unit != kUnitFromHeader) {
      (void)kUnitSize[which](request.column[which]->unit);
    }
    if (column_number(*request.column[which]) == std::size_t{0}) {
      throw InputError(
          fmt::format("{} column 0: columns are counted from 1", kQuantity[which]));
    }
  }
  return request;
}

}  // namespace

MeasurementColumns columns_of_header(const std::filesystem::path& file,
                                     const MeasurementColumns& told) {
  MeasurementColumns columns = told;
  std::optional<NamesAndUnits> header;
  if (told.depth.column.empty() || told.force.column.empty()) {
    header = header_of(read_text_lines(file));
    if (!header) {
      throw InputError(fmt::format(
          "{}: no line of names above the first row of numbers; tell depth and force "
          "column by number, from 1, and their units",
          file.string()));
    }
  }
  MeasurementColumn* asked[] = {&columns.depth, &columns.force};
  for (std::size_t which = 0; which < std::size(asked); ++which) {
    MeasurementColumn& column = *asked[which];
    if (column.column.empty()) {
      column.column = only_one(file.string(), *header, which);
    }
    if (column.unit.empty()) {
      column.unit = kUnitFromHeader;
    }
  }
  return columns;
}

MeasurementFile read_measurement(const std::filesystem::path& file,
                                 const MeasurementColumns& columns,
                                 HeaderUnits header_units) {
  const Request request = make_request(file, columns, header_units);
  const std::vector<TextLine> lines = read_text_lines(file);
  const Table table = find_table(request, lines);
  MeasurementFile result;
  std::string* name[] = {&result.depth_column, &result.force_column,
                         &result.time_column};
  std::vector<double>* samples[] = {&result.samples.depth_m, &result.samples.force_n,
                                    &result.samples.time_s};
  std::size_t begin = table.begin;
  std::optional<TextLine> unit_line;
  if (begin < lines.size() && is_unit_line(request, table, lines[begin])) {
    unit_line = lines[begin++];
  }
  std::vector<double> size;
  for (std::size_t which = 0; which < table.column.size(); ++which) {
    if (table.column[which] < table.header.size()) {
      *name[which] = table.header[table.column[which]];
      check_unit(request, which, parse_column_name(*name[which]).unit,
                 fmt::format("column \"{}\"", *name[which]));
    }
    size.push_back(unit_size(request, table, which, unit_line));
  }
  for (std::size_t i = begin; i < lines.size(); ++i) {
    const Cells cells = split_cells(lines[i].text, table.delimiter);
    if (all_empty(table, cells)) {
      continue;
    }
    for (std::size_t which = 0; which < table.column.size(); ++which) {
      samples[which]->push_back(size[which] *
                                cell_number(request, table, lines[i], cells, which));
    }
  }
  if (result.samples.depth_m.empty()) {
    throw InputError(
        fmt::format("{}: no rows of numbers below the header", request.file));
  }
  return result;
}

MeasurementFile read_measurement(const std::filesystem::path& file,
                                 const MeasurementColumn& depth,
                                 const MeasurementColumn& force,
                                 HeaderUnits header_units) {
  return read_measurement(file, {depth, force, std::nullopt}, header_units);
}

}  // namespace palpate
