#include "precompute/obj_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "formats/error.h"

namespace palpate {
namespace {

// The next word of a line, and takes it away; empty at its end and before a comment.
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

// Whether the whole word is a number; the value is set if it is.
template <typename Number>
bool parse(std::string_view word, Number& value) {
  word.remove_prefix(word.starts_with('+') ? 1 : 0);
  const char* end = word.data() + word.size();
  const auto [after, error] = std::from_chars(word.data(), end, value);
  return error == std::errc() && after == end;
}

Eigen::Vector3d read_point(std::string_view line, std::size_t vertex, int number) {
  Eigen::Vector3d point;
  for (double& coordinate : point) {
    if (!parse(take_word(line), coordinate) || !std::isfinite(coordinate)) {
      throw FormatError(fmt::format("line {}: vertex {} is not three finite numbers",
                                    number, vertex + 1));
    }
  }
  return point;
}

// Corners are numbered from 1; those that lie before the first or are beyond any count
// become one that no vertex has.
std::vector<std::size_t> read_face(std::string_view line, std::size_t vertices,
                                   std::size_t face, int number) {
  std::vector<std::size_t> corners;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
    std::int64_t corner = 0;
    if (!parse(word.substr(0, word.find('/')), corner) || corner == 0) {
      throw FormatError(
          fmt::format("line {}: face {} has the corner {:?}, must be a "
                      "vertex from 1 or from -1 backwards",
                      number, face + 1, word.substr(0, 40)));
    }
    corners.push_back(corner > 0 ? static_cast<std::size_t>(corner - 1)
                                 : vertices + static_cast<std::size_t>(corner));
  }
  return corners;
}

}  // namespace

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

PolygonSoup read_obj(std::string bytes) {
  PolygonSoup soup;
  std::istringstream lines(with_unix_lines(std::move(bytes)));
  int number = 0;
  std::string next;
  for (std::string line; std::getline(lines, line);) {
    const int first = ++number;
    while (line.ends_with('\\') && std::getline(lines, next)) {
      line.back() = ' ';
      line += next;
      ++number;
    }
    std::string_view rest = line;
    const std::string_view statement = take_word(rest);
    if (statement == "v") {
      soup.point.push_back(read_point(rest, soup.point.size(), first));
    } else if (statement == "f") {
      soup.face.push_back(read_face(rest, soup.point.size(), soup.face.size(), first));
    }
  }
  if (soup.point.empty() || soup.face.empty()) {
    throw FormatError(fmt::format("{} vertices (v) and {} faces (f), need some of both",
                                  soup.point.size(), soup.face.size()));
  }
  return soup;
}

}  // namespace palpate
