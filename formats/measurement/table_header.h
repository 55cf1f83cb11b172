// The names and units above a table of numbers in delimited text, and what they tell of
// its columns.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/measurement/delimited_text.h"

namespace palpate {

struct TableHeader {
  char delimiter = ',';
  std::size_t names = 0;  ///< index of the line of names, `begin` where there is none
  std::size_t begin = 0;  ///< index of the first row of numbers
  std::vector<std::string> name;  ///< empty where the table has no line of names
  std::vector<std::string> unit;  ///< as many as names, empty where none is stated
};

/// Whether a line holds two numbers or more and is no part of a header. A line of a
/// header states two units itself, or stands above a line of units. Numbers beside
/// names and units belong to somebody's calculations in the same sheet.
[[nodiscard]] bool is_number_row(std::span<const TextLine> lines, std::size_t row,
                                 char delimiter);

/// What stands above the first row of numbers, `begin` at the earliest. The line before
/// that row is one of names where it has as many cells. Units stand in the names, or in
/// a line of their own between names and numbers.
[[nodiscard]] std::optional<TableHeader> find_header(std::span<const TextLine> lines,
                                                     char delimiter,
                                                     std::size_t begin = 0);

/// The same with tab, semicolon or comma, the first that makes cells of numbers.
[[nodiscard]] std::optional<TableHeader> find_header(std::span<const TextLine> lines);

/// Columns whose unit is one of the quantity (column_name.h).
[[nodiscard]] std::vector<std::size_t> columns_with_unit(const TableHeader& header,
                                                         std::size_t quantity);

/// How a column of the header is asked for: by its name, or by its number where others
/// have the same.
[[nodiscard]] std::string chosen_by(const TableHeader& header, std::size_t column);

/// The unit that a cell of a line of units states: "mm", "(mm)" or "[mm]".
[[nodiscard]] std::string stated_unit(const std::string& cell);

}  // namespace palpate
