#include "formats/measurement/text_table.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/measurement/asked_columns.h"
#include "formats/measurement/column_name.h"
#include "formats/measurement/decimal_mark.h"
#include "formats/measurement/table_header.h"

namespace palpate {
namespace {

using Cells = std::vector<std::string>;

constexpr std::size_t kFirstRows = 3;

std::optional<std::size_t> resolve(const AskedColumns& request, std::size_t which,
                                   const Cells& header) {
  const MeasurementColumn& choice = *request.column[which];
  if (const auto number = column_number(choice.column)) {
    return *number - 1;
  }
  const std::vector<std::size_t> matches = matching_columns(header, choice.column);
  if (matches.size() > 1) {
    throw InputError(fmt::format(
        "{}: {} column \"{}\" may be any of {} columns; choose one by its number",
        request.file, request.what[which], choice.column, matches.size()));
  }
  return matches.empty() ? std::nullopt : std::optional(matches[0]);
}

// All columns by number: the first line in which all are numbers begins the data.
std::optional<TableLayout> find_by_numbers(const AskedColumns& request,
                                           std::span<const TextLine> lines,
                                           char delimiter) {
  std::vector<std::size_t> column;
  for (const MeasurementColumn* choice : request.column) {
    column.push_back(*column_number(choice->column) - 1);
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Cells cells = split_cells(lines[i].text, delimiter);
    if (std::all_of(column.begin(), column.end(), [&](std::size_t which) {
          return numeric(cells, which);
        })) {
      const auto above =
          find_header(lines.first(i + 1), delimiter, i - std::min(i, std::size_t{2}));
      const bool named = above && above->begin == i;
      return TableLayout{delimiter, named ? above->name : Cells{},
                         named ? above->unit : Cells{}, i, column};
    }
  }
  return std::nullopt;
}

// A column by name: the first line that holds the name begins the table.
std::optional<TableLayout> find_by_names(const AskedColumns& request,
                                         std::span<const TextLine> lines,
                                         char delimiter) {
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
      Cells units;
      for (const std::string& cell : cells) {
        units.push_back(parse_column_name(cell).unit);
      }
      return TableLayout{delimiter, cells, units, i + 1, column};
    }
  }
  return std::nullopt;
}

[[noreturn]] void refuse_columns(const AskedColumns& request,
                                 std::span<const TextLine> lines) {
  for (const char delimiter : kDelimiters) {
    const auto table = find_header(lines, delimiter);
    if (!table) {
      continue;
    }
    for (std::size_t which = 0; which < request.column.size(); ++which) {
      const std::string& name = request.column[which]->column;
      if (!column_number(name) && !resolve(request, which, table->name)) {
        throw InputError(fmt::format("{}: no {} column \"{}\"; columns found: {}",
                                     request.file, request.what[which], name,
                                     table->name.empty()
                                         ? "none has a name; choose by number, from 1"
                                         : nearest_columns(table->name, name)));
      }
    }
    throw InputError(fmt::format(
        "{}: columns {} and {} hold no row of numbers; line {} has {} columns",
        request.file, request.column[0]->column, request.column[1]->column,
        lines[table->begin].number,
        split_cells(lines[table->begin].text, delimiter).size()));
  }
  throw InputError(
      fmt::format("{}: no row with two numbers or more, separated by comma, semicolon, "
                  "tab or blanks",
                  request.file));
}

TableLayout find_table(const AskedColumns& request, std::span<const TextLine> lines) {
  const bool numbers = std::all_of(request.column.begin(), request.column.end(),
                                   [](const MeasurementColumn* choice) {
                                     return column_number(choice->column).has_value();
                                   });
  for (const char delimiter : kDelimiters) {
    const auto table = numbers ? find_by_numbers(request, lines, delimiter)
                               : find_by_names(request, lines, delimiter);
    if (table) {
      return *table;
    }
  }
  refuse_columns(request, lines);
}

double cell_number(const AskedColumns& request, const TableLayout& table,
                   const TextLine& line, const Cells& cells, std::size_t which) {
  const std::size_t column = table.column[which];
  const std::string name =
      column < table.header.size() ? fmt::format(" \"{}\"", table.header[column]) : "";
  if (column >= cells.size()) {
    throw FormatError(fmt::format("{}: line {} has {} cells, column {}{} is missing",
                                  request.file, line.number, cells.size(), column + 1,
                                  name));
  }
  const auto value = parse_number(cells[column], true);
  if (!value || !std::isfinite(*value)) {
    const bool digits =
        cells[column].find_first_of("0123456789") != std::string::npos &&
        cells[column].find_first_of(",.' ") != std::string::npos;
    throw FormatError(
        fmt::format("{}: line {}, column {}{}: \"{}\" is not a finite "
                    "number{}",
                    request.file, line.number, column + 1, name, cells[column],
                    digits ? " (thousands separators are not read)" : ""));
  }
  return *value;
}

// "" or "NaN", as programs write what is missing.
bool is_missing(const std::string& cell) {
  const auto value = parse_number(cell, false);
  return cell.empty() || (value && std::isnan(*value));
}

bool all_missing(const TableLayout& table, const Cells& cells) {
  return std::all_of(table.column.begin(), table.column.end(), [&](std::size_t column) {
    return column < cells.size() && is_missing(cells[column]);
  });
}

bool has_empty_cell(const TableLayout& table, const TextLine& line) {
  const Cells cells = split_cells(line.text, table.delimiter);
  return std::any_of(table.column.begin(), table.column.end(), [&](std::size_t column) {
    return column >= cells.size() || cells[column].empty();
  });
}

// Without the rows behind the table: those below an empty line of which none fills all
// columns, as a mean below its column does not.
std::span<const TextLine> within_table(const TableLayout& table,
                                       std::span<const TextLine> lines) {
  std::size_t end = lines.size();
  while (end > 0 && has_empty_cell(table, lines[end - 1])) {
    --end;
  }
  while (end > 0 && end < lines.size() &&
         lines[end].number == lines[end - 1].number + 1) {
    ++end;
  }
  return lines.first(end == 0 ? lines.size() : end);
}

// A word alone among the first rows, as "eoh" at the end of a header, is none of them;
// its place, or that of the end.
std::size_t word_among(const TableLayout& table, std::span<const TextLine> rows) {
  const auto first = rows.first(std::min(rows.size(), kFirstRows));
  const auto found =
      std::find_if(first.begin(), first.end(), [&](const TextLine& line) {
        const Cells cells = split_cells(line.text, table.delimiter);
        const auto filled =
            std::count_if(cells.begin(), cells.end(), [](const auto& cell) {
              return !cell.empty();
            });
        return filled == 1 &&
               line.text.find_first_of("0123456789") == std::string::npos;
      });
  return found == first.end() ? rows.size()
                              : static_cast<std::size_t>(found - first.begin());
}

bool any_nan(const TableLayout& table, const Cells& cells) {
  return std::any_of(table.column.begin(), table.column.end(), [&](std::size_t column) {
    const auto value =
        column < cells.size() ? parse_number(cells[column], true) : std::nullopt;
    return value && std::isnan(*value);
  });
}

// @return rows left out for a NaN, where `skips_nan`.
std::size_t read_rows(const AskedColumns& request, const TableLayout& table,
                      std::span<const TextLine> lines, const std::vector<double>& size,
                      bool skips_nan) {
  DecimalMark mark(request.file);
  std::size_t skipped = 0;
  for (const TextLine& line : lines) {
    const Cells cells = split_cells(line.text, table.delimiter);
    if (all_missing(table, cells)) {
      continue;
    }
    if (skips_nan && any_nan(table, cells)) {
      ++skipped;
      continue;
    }
    for (std::size_t which = 0; which < table.column.size(); ++which) {
      request.samples[which]->push_back(
          size[which] * cell_number(request, table, line, cells, which));
      mark.see(cells[table.column[which]], line.number);
    }
  }
  mark.check();
  return skipped;
}

}  // namespace

MeasurementFile read_table(const std::string& file, std::span<const TextLine> lines,
                           const MeasurementColumns& columns,
                           HeaderUnits header_units) {
  MeasurementFile result;
  std::string unnamed;
  const AskedColumns request =
      asked_columns(file, columns, header_units, result, unnamed);
  TableLayout table = find_table(request, lines);
  std::size_t begin = table.begin;
  if (begin < lines.size() && take_unit_line(request, lines[begin], table)) {
    ++begin;
  }
  std::vector<double> size;
  for (std::size_t which = 0; which < table.column.size(); ++which) {
    if (table.column[which] < table.header.size()) {
      *request.name[which] = table.header[table.column[which]];
    }
    size.push_back(unit_size(request, table, which));
  }
  const auto rows = lines.subspan(begin);
  const auto within = within_table(table, rows);
  if (within.size() < rows.size()) {
    result.notes.push_back(fmt::format(
        "line {} stands below an empty one and is no row of the table, nor is any "
        "after it",
        rows[within.size()].number));
  }
  const std::size_t word = word_among(table, within);
  if (word < within.size()) {
    result.notes.push_back(fmt::format("line {} (\"{}\") holds no number: left out",
                                       within[word].number,
                                       trimmed(within[word].text)));
  }
  const bool skips_nan = columns.lateral.has_value();
  std::size_t skipped = read_rows(request, table, within.first(word), size, skips_nan);
  if (word < within.size()) {
    skipped += read_rows(request, table, within.subspan(word + 1), size, skips_nan);
  }
  if (skipped > 0) {
    result.notes.push_back(fmt::format("rows with NaN left out: {}", skipped));
  }
  if (result.samples.depth_m.empty()) {
    throw InputError(
        fmt::format("{}: no rows of numbers below the header", request.file));
  }
  return result;
}

}  // namespace palpate
