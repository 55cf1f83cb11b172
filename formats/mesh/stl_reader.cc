#include "formats/mesh/stl_reader.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/mesh/mesh_text.h"
#include "formats/mesh/obj_reader.h"
#include "formats/mesh/off_reader.h"
#include "formats/mesh/ply_reader.h"
#include "formats/mesh/weld_points.h"

namespace palpate {
namespace {

constexpr std::size_t kStlHeader = 84;
constexpr std::size_t kStlTriangle = 50;

std::size_t stl_count(const std::string& bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  return count;
}

// Small letters, and no name after (end)solid, which could be a word that means
// something.
std::string plain_stl(std::string_view text) {
  std::string plain;
  std::istringstream lines(with_unix_lines(std::string(text)));
  for (std::string line; std::getline(lines, line);) {
    std::transform(line.begin(), line.end(), line.begin(), [](unsigned char c) {
      return static_cast<char>(std::tolower(c));
    });
    line.erase(0, std::min(line.find_first_not_of(" \t"), line.size()));
    for (const std::string_view named : {"solid", "endsolid"}) {
      if (line.starts_with(named)) {
        line = named;
      }
    }
    plain += line + '\n';
  }
  return plain;
}

std::string stl_sizes(const std::string& bytes) {
  if (bytes.size() < kStlHeader) {
    return fmt::format("{} bytes, neither text (\"solid\") nor a binary header of 84",
                       bytes.size());
  }
  return fmt::format(
      "cut short or not STL: the header announces {} triangles, {} bytes, but the file "
      "has {}",
      stl_count(bytes), kStlHeader + kStlTriangle * stl_count(bytes), bytes.size());
}

// Triangles by their corners: equal points become one.
class CornerSoup {
 public:
  void add(const Eigen::Vector3d& point) {
    std::array<std::uint64_t, 3> key{};
    for (std::size_t k = 0; k < 3; ++k) {  // + 0.0: one zero, not two
      key[k] = std::bit_cast<std::uint64_t>(point[static_cast<Eigen::Index>(k)] + 0.0);
    }
    const auto [at, is_new] = place_.emplace(key, soup_.point.size());
    if (is_new) {
      soup_.point.push_back(point);
    }
    corner_.push_back(at->second);
  }
  /// @return whether the corners since the last face were three.
  [[nodiscard]] bool close_face() {
    const bool three = corner_.size() == 3;
    soup_.face.push_back(std::move(corner_));
    corner_.clear();
    return three;
  }
  [[nodiscard]] PolygonSoup& soup() { return soup_; }

 private:
  PolygonSoup soup_;
  std::vector<std::size_t> corner_;
  std::map<std::array<std::uint64_t, 3>, std::size_t> place_;
};

// Corners of neighbours that exporters have rounded apart.
void weld_rounded(PolygonSoup& soup) {
  const std::vector<std::size_t> first =
      first_within(soup.point, rounding_of(soup.point));
  // first[v] <= v is the vertex that v becomes; number counts those that stay.
  std::vector<std::size_t> number(first.size());
  std::vector<Eigen::Vector3d> kept;
  for (std::size_t v = 0; v < first.size(); ++v) {
    number[v] = first[v] == v ? kept.size() : number[first[v]];
    if (first[v] == v) {
      kept.push_back(soup.point[v]);
    }
  }
  if (kept.size() == soup.point.size()) {
    return;
  }
  std::vector<std::vector<std::size_t>> whole;
  for (std::vector<std::size_t>& face : soup.face) {
    for (std::size_t& corner : face) {
      corner = number[corner];
    }
    // A triangle of which two corners became one has no area.
    if (face.size() != 3 ||
        (face[0] != face[1] && face[1] != face[2] && face[2] != face[0])) {
      whole.push_back(std::move(face));
    }
  }
  soup.note.push_back(fmt::format(
      "{} vertices that differed by rounding alone are welded, to {:.2g} of the file's "
      "unit; {} triangles had no size",
      soup.point.size() - kept.size(), rounding_of(soup.point),
      soup.face.size() - whole.size()));
  soup.point = std::move(kept);
  soup.face = std::move(whole);
}

PolygonSoup read_binary_stl(const std::string& bytes) {
  constexpr std::size_t kNormal = 12;
  CornerSoup corners;
  for (std::size_t t = 0; t < stl_count(bytes); ++t) {
    for (std::size_t j = 0; j < 3; ++j) {
      std::array<float, 3> p{};
      std::memcpy(p.data(),
                  bytes.data() + kStlHeader + kStlTriangle * t + kNormal + 12 * j,
                  sizeof(p));
      corners.add(Eigen::Map<const Eigen::Vector3f>(p.data()).cast<double>());
    }
    (void)corners.close_face();
  }
  return std::move(corners.soup());
}

PolygonSoup read_text_stl(const std::string& plain) {
  CornerSoup corners;
  std::istringstream lines(plain);
  std::size_t vertices = 0;
  int number = 0;
  bool whole = false;  // no facet or solid is open
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::string_view words = line;
    std::string_view word = take_word(words);
    if (constexpr std::string_view kVertex = "vertex"; word.starts_with(kVertex)) {
      // The number may stand close to it.
      words = std::string_view(line).substr(line.find(kVertex) + kVertex.size());
      word = kVertex;
    }
    if (word == "vertex") {
      corners.add(read_point(words, ++vertices, number));
    } else if (word == "endfacet" && !corners.close_face()) {
      throw FormatError(fmt::format("line {}: facet {} has not three vertices", number,
                                    corners.soup().face.size()));
    }
    whole = word.empty() ? whole : word == "endsolid";
  }
  if (!whole) {
    throw FormatError(fmt::format("cut short or not STL after {} triangles",
                                  corners.soup().face.size()));
  }
  return std::move(corners.soup());
}

// Binary by its size: some binary files start with "solid". Text has no zero byte.
PolygonSoup read_stl(const std::string& bytes) {
  static_assert(std::endian::native == std::endian::little);
  const std::size_t whole =
      bytes.size() < kStlHeader ? 0 : kStlHeader + kStlTriangle * stl_count(bytes);
  if (whole > 0 && bytes.size() == whole) {
    return read_binary_stl(bytes);
  }
  std::string plain = plain_stl(bytes);
  plain.erase(0, std::min(plain.find_first_not_of('\n'), plain.size()));
  if (bytes.find('\0') == std::string::npos && plain.starts_with("solid")) {
    return read_text_stl(plain);
  }
  if (whole <= kStlHeader || bytes.size() < whole ||
      bytes.size() >= whole + kStlTriangle) {
    throw FormatError(stl_sizes(bytes));
  }
  PolygonSoup soup = read_binary_stl(bytes);
  soup.note.push_back(
      fmt::format("{} bytes behind the last triangle are passed over; all that the "
                  "header announces are there",
                  bytes.size() - whole));
  return soup;
}

}  // namespace

PolygonSoup read_polygon_soup(std::string bytes, std::string_view extension) {
  if (extension == ".obj") {
    return read_obj(std::move(bytes));
  }
  if (extension == ".ply") {
    return read_ply(bytes);
  }
  if (extension == ".off") {
    return read_off(std::move(bytes));
  }
  if (extension == ".stl") {
    PolygonSoup soup = read_stl(bytes);
    weld_rounded(soup);
    return soup;
  }
  throw FormatError(fmt::format("unknown extension \"{}\"", extension));
}

}  // namespace palpate
