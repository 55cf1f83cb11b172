// Delimited text as instruments and spreadsheets export it: lines, cells, numbers.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

struct TextLine {
  std::size_t number = 0;  ///< counted from 1, as editors do
  std::string text;        ///< without its end of line
};

/// Those of tables, in the order in which they are tried.
inline constexpr std::array kDelimiters{'\t', ';', ',', ' '};

/// The lines that carry something. Blank lines and those that start with '#', or above
/// all others with '%', are left out. A byte order mark and carriage returns are taken
/// off. Of comments above a first row that starts with a number the last is kept,
/// without its '#': it may name the columns. A line that is no UTF-8 is taken as
/// Latin-1 and given as UTF-8.
/// @throws InputError if the file cannot be read, FormatError if it is not 8-bit text.
[[nodiscard]] std::vector<TextLine> read_text_lines(const std::filesystem::path& file);

/// The same of text in memory.
/// @param file for messages. @param first_number of the text's first line.
/// @throws FormatError if it is not 8-bit text.
[[nodiscard]] std::vector<TextLine> text_lines(std::string_view text,
                                               const std::string& file,
                                               std::size_t first_number = 1);

/// Without blanks, tabs and carriage returns at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// Cells between delimiters, blanks around them taken off. A cell in double quotes may
/// hold the delimiter; "" inside it is one quote. Commas that separate thousands before
/// a decimal point, "1,000.06", are taken out of lines with quotes. The delimiter ' '
/// stands for any blanks, and a unit in brackets behind them belongs to the cell
/// before.
[[nodiscard]] std::vector<std::string> split_cells(std::string_view line,
                                                   char delimiter);

/// The number that fills the whole cell: decimal point, or where allowed decimal comma;
/// no thousands separators. Reads "nan" and "inf" as what they are.
[[nodiscard]] std::optional<double> parse_number(std::string_view cell,
                                                 bool decimal_comma);

/// Whether the cell's digits end in groups of three behind `separator`, as a thousands
/// separator makes them, and a decimal mark may: "1,234", "12.345.678".
[[nodiscard]] bool ends_in_groups(std::string_view cell, char separator);

}  // namespace palpate
