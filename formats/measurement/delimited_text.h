// Delimited text as instruments and spreadsheets export it: lines, cells, numbers.
#pragma once

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

/// The lines that carry something: blank lines and those that start with '#' are left
/// out, a byte order mark and carriage returns taken off.
/// @throws InputError if the file cannot be read, FormatError if it is not 8-bit text.
[[nodiscard]] std::vector<TextLine> read_text_lines(const std::filesystem::path& file);

/// Cells between delimiters, blanks around them taken off. A cell in double quotes may
/// hold the delimiter; "" inside it is one quote.
[[nodiscard]] std::vector<std::string> split_cells(std::string_view line,
                                                   char delimiter);

/// The number that fills the whole cell: decimal point, or where allowed decimal comma;
/// no thousands separators. Reads "nan" and "inf" as what they are.
[[nodiscard]] std::optional<double> parse_number(std::string_view cell,
                                                 bool decimal_comma);

}  // namespace palpate
