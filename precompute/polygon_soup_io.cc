#include "precompute/polygon_soup_io.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <exception>
#include <sstream>

#include <CGAL/IO/STL.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include "formats/error.h"
#include "precompute/mesh_words.h"
#include "precompute/obj_reader.h"
#include "precompute/off_reader.h"
#include "precompute/ply_reader.h"

namespace palpate {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;

struct CgalSoup {
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> polygons;
};

constexpr std::size_t kStlHeader = 84;
constexpr std::size_t kStlTriangle = 50;

std::size_t stl_count(const std::string& bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  return count;
}

// As CGAL's reader knows it: small letters, and no name after (end)solid, which could
// be a word that means something.
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

// Binary by its size: some binary files start with "solid". Text has no zero byte.
CgalSoup read_stl(std::string bytes) {
  static_assert(std::endian::native == std::endian::little);
  const bool binary = bytes.size() >= kStlHeader &&
                      bytes.size() == kStlHeader + kStlTriangle * stl_count(bytes);
  if (binary) {
    bytes.replace(0, 6, "binary");  // tells CGAL which of the two to read
  } else {
    std::string plain = plain_stl(bytes);
    plain.erase(0, std::min(plain.find_first_not_of('\n'), plain.size()));
    const bool has_zeros = bytes.find('\0') != std::string::npos;
    if (has_zeros || !plain.starts_with("solid")) {
      throw FormatError(stl_sizes(bytes));
    }
    bytes = "solid \n" + plain.substr(std::string_view("solid").size());
  }
  CgalSoup soup;
  std::istringstream in(std::move(bytes));
  if (!CGAL::IO::read_STL(in, soup.points, soup.polygons)) {
    throw FormatError(
        fmt::format("cut short or not STL after {} triangles", soup.polygons.size()));
  }
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
  if (extension != ".stl") {
    throw FormatError(fmt::format("unknown extension \"{}\"", extension));
  }
  CgalSoup read;
  try {
    read = read_stl(std::move(bytes));
  } catch (const Error&) {
    throw;
  } catch (const std::exception&) {  // CGAL's own
    throw FormatError("not STL");
  }
  PolygonSoup soup;
  for (const Point& p : read.points) {
    soup.point.emplace_back(p.x(), p.y(), p.z());
  }
  soup.face = std::move(read.polygons);
  return soup;
}

}  // namespace palpate
