#include "formats/measurement/column_name.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <functional>
#include <initializer_list>
#include <numeric>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/units.h"

namespace palpate {
namespace {

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return lower;
}

std::string without_end_blanks(std::string_view text) {
  return std::string(text.substr(0, text.find_last_not_of(" \t") + 1));
}

// Units that headers spell out, in the singular and in lower case.
constexpr std::array<std::string_view, 2> kUnitWords[] = {
    {"meter", "m"},        {"metre", "m"},       {"centimeter", "cm"},
    {"centimetre", "cm"},  {"millimeter", "mm"}, {"millimetre", "mm"},
    {"micrometer", "um"},  {"micrometre", "um"}, {"micron", "um"},
    {"nanometer", "nm"},   {"nanometre", "nm"},  {"inch", "in"},
    {"inche", "in"},       {"newton", "N"},      {"kilonewton", "kN"},
    {"millinewton", "mN"}, {"gram", "g"},        {"kilogram", "kg"},
    {"pound", "lb"},       {"lb", "lb"},         {"second", "s"}};

std::string_view symbol(std::string_view unit) {
  std::string word = lower_case(unit);
  if (word.size() > 2 && word.ends_with('s')) {
    word.pop_back();
  }
  const auto* const found =
      std::find_if(std::begin(kUnitWords), std::end(kUnitWords), [&](const auto& pair) {
        return pair[0] == word;
      });
  return found == std::end(kUnitWords) ? unit : (*found)[1];
}

std::optional<double> known(double (*size)(std::string_view), std::string_view unit) {
  try {
    return size(symbol(unit));
  } catch (const InputError&) {
    return std::nullopt;
  }
}

bool holds_any(std::string_view text, std::initializer_list<const char*> words) {
  const std::string lower = lower_case(text);
  return std::any_of(words.begin(), words.end(), [&](const char* word) {
    return lower.find(word) != std::string::npos;
  });
}

bool is_force_name(std::string_view quantity) {
  const std::string lower = lower_case(quantity);
  return lower == "f" || lower == "fx" || lower == "fy" || lower == "fz" ||
         holds_any(lower, {"force", "load", "kraft", "weight"});
}

bool is_time_name(std::string_view quantity) {
  return lower_case(quantity) == "t" || holds_any(quantity, {"time", "zeit"});
}

bool is_plain_time(std::string_view unit) {
  return unit == "s" || unit == "ms" || unit == "us" || unit == "ns" || unit == "µs";
}

// "Load N" and "Depth mm", but neither "Cycle N" nor "Rise in".
bool is_no_word(const ColumnName& name) {
  return (name.unit.size() > 1 && name.unit != "in") ||
         (force_unit_si(name.unit) && is_force_name(name.quantity)) ||
         (time_unit_si(name.unit) && is_time_name(name.quantity));
}

// Levenshtein's distance, one row at a time.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t change = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({change, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::optional<double> length_unit_si(std::string_view unit) {
  return known(metres_per, unit);
}

std::optional<double> force_unit_si(std::string_view unit) {
  return known(newtons_per, unit);
}

std::optional<double> time_unit_si(std::string_view unit) {
  return known(seconds_per, unit);
}

std::optional<double> unit_si(std::size_t quantity, std::string_view unit) {
  return quantity == kDepth   ? length_unit_si(unit)
         : quantity == kForce ? force_unit_si(unit)
                              : time_unit_si(unit);
}

bool is_known_unit(std::string_view unit) {
  return time_unit_si(unit) || length_unit_si(unit) || force_unit_si(unit);
}

std::optional<std::size_t> column_number(std::string_view choice) {
  std::size_t number = 0;
  const char* end = choice.data() + choice.size();
  const auto [stop, error] = std::from_chars(choice.data(), end, number);
  if (error != std::errc() || stop != end) {
    return std::nullopt;
  }
  return number;
}

std::string unit_beside(std::string_view quantity, std::string_view unit) {
  const std::string_view brief = symbol(unit);
  const bool mass = brief == "g" || brief == "kg" || brief == "lb";
  return mass && is_force_name(quantity) ? std::string(brief) + "f" : std::string(unit);
}

ColumnName parse_column_name(std::string_view header) {
  const auto taken = [](std::string_view quantity, std::string_view unit) {
    const std::string name = without_end_blanks(quantity);
    return ColumnName{name, unit_beside(name, unit)};
  };
  const char end = header.empty() ? ' ' : header.back();
  if (end == ')' || end == ']') {
    const std::size_t open = header.find_last_of(end == ')' ? '(' : '[');
    if (open != std::string_view::npos) {
      return taken(header.substr(0, open),
                   header.substr(open + 1, header.size() - open - 2));
    }
  }
  const std::size_t comma = header.find_last_of(',');
  if (comma != std::string_view::npos) {
    std::string_view unit = header.substr(comma + 1);
    unit.remove_prefix(std::min(unit.find_first_not_of(' '), unit.size()));
    const ColumnName name = taken(header.substr(0, comma), unit);
    if (is_known_unit(name.unit)) {
      return name;
    }
  }
  for (const char bar : {'_', ' '}) {
    const std::size_t at = header.find_last_of(bar);
    if (at != std::string_view::npos) {
      const ColumnName name = taken(header.substr(0, at), header.substr(at + 1));
      if (is_known_unit(name.unit) && (bar == '_' || is_no_word(name)) &&
          (!time_unit_si(name.unit) || is_plain_time(name.unit) ||
           is_time_name(name.quantity))) {
        return name;
      }
    }
  }
  return {std::string(header), ""};
}

std::vector<std::size_t> matching_columns(const std::vector<std::string>& headers,
                                          std::string_view name) {
  // A mark of comments before the line of names belongs to no name.
  if (const std::size_t mark = name.find_first_not_of("%# ");
      mark > 0 && mark < name.size()) {
    if (auto exact = std::find(headers.begin(), headers.end(), name);
        exact == headers.end()) {
      name.remove_prefix(mark);
    }
  }
  using Reading = std::function<std::string(const std::string&)>;
  const std::string lower = lower_case(name);
  const Reading readings[] = {[](const std::string& header) {
                                return header;
                              },
                              [](const std::string& header) {
                                return lower_case(header);
                              },
                              [](const std::string& header) {
                                return lower_case(parse_column_name(header).quantity);
                              }};
  for (const Reading& reading : readings) {
    std::vector<std::size_t> matches;
    for (std::size_t i = 0; i < headers.size(); ++i) {
      if (reading(headers[i]) == (&reading == readings ? std::string(name) : lower)) {
        matches.push_back(i);
      }
    }
    if (!matches.empty()) {
      return matches;
    }
  }
  return {};
}

std::string nearest_columns(std::vector<std::string> headers, std::string_view name) {
  const std::string lower = lower_case(name);
  const auto distance = [&](const std::string& header) {
    return edit_distance(lower_case(parse_column_name(header).quantity), lower);
  };
  std::stable_sort(headers.begin(), headers.end(), [&](const auto& a, const auto& b) {
    return distance(a) < distance(b);
  });
  std::string list;
  for (const std::string& header : headers) {
    list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", header);
  }
  return list;
}

}  // namespace palpate
