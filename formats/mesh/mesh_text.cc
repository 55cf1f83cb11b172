#include "formats/mesh/mesh_text.h"

#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

std::string_view take_word(std::string_view& line) {
  constexpr std::string_view kBlank = " \t\v\f";
  line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
  if (line.starts_with('#')) {
    line = {};
  }
  const std::string_view word = line.substr(0, line.find_first_of(kBlank));
  line.remove_prefix(word.size());
  return word;
}

Eigen::Vector3d read_point(std::string_view words, std::size_t vertex, int number) {
  Eigen::Vector3d point;
  for (double& coordinate : point) {
    if (!parse_number(take_word(words), coordinate) || !std::isfinite(coordinate)) {
      throw FormatError(fmt::format("line {}: vertex {} is not three finite numbers",
                                    number, vertex));
    }
  }
  return point;
}

std::string with_unix_lines(std::string bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) {
    bytes.erase(0, 3);
  }
  std::size_t to = 0;
  for (std::size_t from = 0; from < bytes.size(); ++from) {
    const bool is_return = bytes[from] == '\r';
    if (!is_return || from + 1 == bytes.size() || bytes[from + 1] != '\n') {
      bytes[to++] = is_return ? '\n' : bytes[from];
    }
  }
  bytes.resize(to);
  return bytes;
}

}  // namespace palpate
