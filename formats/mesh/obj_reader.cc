#include "formats/mesh/obj_reader.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/mesh/mesh_text.h"

namespace palpate {
namespace {

// Corners are numbered from 1; those that lie before the first or are beyond any count
// become one that no vertex has.
std::vector<std::size_t> read_obj_face(std::string_view line, std::size_t vertices,
                                       std::size_t face, int number) {
  std::vector<std::size_t> corners;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
    std::int64_t corner = 0;
    if (!parse_number(word.substr(0, word.find('/')), corner) || corner == 0) {
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

PolygonSoup read_obj(std::string bytes) {
  PolygonSoup soup;
  std::istringstream lines(with_unix_lines(std::move(bytes)));
  int number = 0;
  std::string next;
  for (std::string line; std::getline(lines, line);) {
    const int first = ++number;
    // A backslash at its end joins a line with the next.
    while (line.ends_with('\\') && std::getline(lines, next)) {
      line.back() = ' ';
      line += next;
      ++number;
    }
    std::string_view rest = line;
    // "v x y z" and "f v/vt/vn ...", v from 1 or backwards from -1; all else is passed
    // over.
    const std::string_view statement = take_word(rest);
    if (statement == "v") {
      soup.point.push_back(read_point(rest, soup.point.size() + 1, first));
    } else if (statement == "f") {
      soup.face.push_back(
          read_obj_face(rest, soup.point.size(), soup.face.size(), first));
    }
  }
  if (soup.point.empty() || soup.face.empty()) {
    throw FormatError(fmt::format("{} vertices (v) and {} faces (f), need some of both",
                                  soup.point.size(), soup.face.size()));
  }
  return soup;
}

}  // namespace palpate
