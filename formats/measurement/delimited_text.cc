#include "formats/measurement/delimited_text.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/printable.h"

namespace palpate {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

// Bytes of Latin-1 as UTF-8, where the line is none yet.
std::string as_utf8(std::string_view line) {
  bool utf8 = true;
  for (std::size_t at = 0; at < line.size() && utf8;) {
    const std::size_t length = utf8_length(line, at);
    utf8 = length > 0;
    at += length;
  }
  if (utf8) {
    return std::string(line);
  }
  std::string text;
  for (const char c : line) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      text += c;
    } else {
      text += static_cast<char>(0xC0 | (byte >> 6));
      text += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return text;
}

bool starts_with_number(std::string_view line) {
  const std::string_view content = trimmed(line);
  const std::size_t first = content.find_first_not_of("+-.,");
  return first != std::string_view::npos && first <= 2 && content[first] >= '0' &&
         content[first] <= '9';
}

// Without what is none: a unit in brackets belongs to the name before.
std::vector<std::string> joined_cells(const std::vector<std::string>& cells) {
  std::vector<std::string> joined;
  for (const std::string& cell : cells) {
    if (!joined.empty() && (cell.starts_with('(') || cell.starts_with('['))) {
      joined.back() += " " + cell;
    } else if (!cell.empty()) {
      joined.push_back(cell);
    }
  }
  return joined;
}

// "1,000.062" in quotes: the point tells what the commas are.
void drop_thousands(std::string& cell) {
  const std::size_t point = cell.find('.');
  if (point == std::string::npos || cell.find(',') > point) {
    return;
  }
  const std::size_t sign = cell.front() == '-' || cell.front() == '+' ? 1 : 0;
  const std::string_view whole = std::string_view(cell).substr(sign, point - sign);
  if (ends_in_groups(whole, ',') && whole.front() != ',' &&
      whole.find_first_not_of("0123456789,") == std::string_view::npos &&
      cell.find_first_not_of("0123456789", point + 1) == std::string::npos) {
    std::erase(cell, ',');
  }
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::vector<TextLine> text_lines(std::string_view text, const std::string& file,
                                 std::size_t first_number) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    throw FormatError(fmt::format("{}: is text in UTF-16; save it as UTF-8", file));
  }
  if (text.starts_with(kByteOrderMark)) {
    text.remove_prefix(kByteOrderMark.size());
  }
  std::vector<TextLine> lines;
  TextLine comment;
  const char end_of_line = text.find('\n') == std::string_view::npos ? '\r' : '\n';
  for (std::size_t number = first_number; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find(end_of_line), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.find('\0') != std::string_view::npos) {
      throw FormatError(fmt::format(
          "{}: line {} holds a zero byte: not delimited text in ASCII or UTF-8", file,
          number));
    }
    if (line.ends_with('\r')) {
      line.remove_suffix(1);
    }
    const std::string_view content = trimmed(line);
    if (content.starts_with('#') || (lines.empty() && content.starts_with('%'))) {
      comment = {number, as_utf8(trimmed(content.substr(1)))};
    } else if (!content.empty()) {
      // The last comment above a first row of numbers names the columns.
      if (lines.empty() && !comment.text.empty() && starts_with_number(content)) {
        lines.push_back(comment);
      }
      lines.push_back({number, as_utf8(line)});
    }
  }
  return lines;
}

std::vector<TextLine> read_text_lines(const std::filesystem::path& file) {
  return text_lines(read_file(file), file.string());
}

std::vector<std::string> split_cells(std::string_view line, char delimiter) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  const bool quotes = line.find('"') != std::string_view::npos;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool quote = line[i] == '"';
    // Two quotes within quotes are one quote of the text.
    if (quote && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += line[i++];
    } else if (quote) {
      quoted = !quoted;
    } else if (!quoted &&
               (line[i] == delimiter || (delimiter == ' ' && line[i] == '\t'))) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  for (std::string& cell : cells) {
    cell = std::string(trimmed(cell));
    if (quotes) {
      drop_thousands(cell);
    }
  }
  return delimiter == ' ' ? joined_cells(cells) : cells;
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

bool ends_in_groups(std::string_view cell, char separator) {
  const std::size_t first = cell.find(separator);
  if (first == std::string_view::npos || first == 0 || first > 4) {
    return false;
  }
  std::string_view rest = cell.substr(first);
  while (rest.size() >= 4 && rest.front() == separator &&
         rest.substr(1, 3).find_first_not_of("0123456789") == std::string_view::npos) {
    rest.remove_prefix(4);
  }
  return rest.empty();
}

}  // namespace palpate
