#include "fitting/session/csv_cell.h"

#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace palpate {

std::string csv_text(std::string text) {
  if (!text.empty() &&
      std::string_view("=+-@\t\r").find(text[0]) != std::string::npos) {
    text.insert(0, 1, '\'');
  }
  if (text.find_first_of(",\"\n\r") == std::string::npos) {
    return text;
  }
  std::string safe = "\"";
  for (const char c : text) {
    safe += c == '"' ? "\"\"" : std::string(1, c);
  }
  return safe + "\"";
}

std::string csv_number(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : "";
}

}  // namespace palpate
