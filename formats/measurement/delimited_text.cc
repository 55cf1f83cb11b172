#include "formats/measurement/delimited_text.h"

#include <algorithm>
#include <charconv>
#include <sstream>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"

namespace palpate {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

}  // namespace

std::vector<TextLine> read_text_lines(const std::filesystem::path& file) {
  std::istringstream stream(read_file(file));
  std::vector<TextLine> lines;
  std::string text;
  for (std::size_t number = 1; std::getline(stream, text); ++number) {
    if (text.find('\0') != std::string::npos) {
      throw FormatError(fmt::format(
          "{}: line {} holds a zero byte: not delimited text in ASCII or UTF-8",
          file.string(), number));
    }
    if (number == 1 && text.starts_with(kByteOrderMark)) {
      text.erase(0, kByteOrderMark.size());
    }
    if (!text.empty() && text.back() == '\r') {
      text.pop_back();
    }
    const std::string_view content = trimmed(text);
    if (!content.empty() && content.front() != '#') {
      lines.push_back({number, text});
    }
  }
  return lines;
}

std::vector<std::string> split_cells(std::string_view line, char delimiter) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool quote = line[i] == '"';
    if (quote && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += line[i++];
    } else if (quote) {
      quoted = !quoted;
    } else if (line[i] == delimiter && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  for (std::string& cell : cells) {
    cell = std::string(trimmed(cell));
  }
  return cells;
}

std::optional<double> parse_number(std::string_view cell, bool decimal_comma) {
  std::string text(trimmed(cell));
  if (decimal_comma && std::count(text.begin(), text.end(), ',') == 1 &&
      text.find('.') == std::string::npos) {
    text[text.find(',')] = '.';
  }
  // from_chars takes no plus sign.
  const std::size_t sign = text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0;
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + sign, end, value);
  if (error != std::errc() || stop != end) {
    return std::nullopt;
  }
  return value;
}

}  // namespace palpate
