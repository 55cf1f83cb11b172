// Cells of tables for spreadsheets.
#pragma once

#include <string>

namespace palpate {

/// A cell with a comma, quote or line end in quotes; the quotes inside doubled. What a
/// spreadsheet would run as a formula begins with an apostrophe, which it takes for
/// text.
[[nodiscard]] std::string csv_text(std::string text);

/// Nine digits; empty where the number is not known.
[[nodiscard]] std::string csv_number(double value);

}  // namespace palpate
