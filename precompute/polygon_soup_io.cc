#include "precompute/polygon_soup_io.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <exception>
#include <sstream>

#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/IO/STL.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include "formats/error.h"

namespace palpate {
namespace {

using CGAL::parameters::verbose;
using Point = CGAL::Simple_cartesian<double>::Point_3;

struct CgalSoup {
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> polygons;
};

bool is_statement(std::string_view line, char letter) {
  return line.size() > 1 && line[0] == letter && line[1] == ' ';
}

// CGAL's OBJ reader stops, silently, at a statement that it does not know, and splits
// the corners of a face at blanks only. So it is given the points and faces alone.
CgalSoup read_obj(const std::string& bytes) {
  std::string kept;
  kept.reserve(bytes.size());
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::istringstream lines(bytes);
  for (std::string line; std::getline(lines, line);) {
    std::replace(line.begin(), line.end(), '\t', ' ');
    line.erase(0, std::min(line.find_first_not_of(' '), line.size()));
    const bool vertex = is_statement(line, 'v');
    const bool face = is_statement(line, 'f');
    vertices += vertex ? 1 : 0;
    faces += face ? 1 : 0;
    if (vertex || face) {
      kept += line;
      kept += '\n';
    }
  }
  if (vertices == 0 || faces == 0) {
    throw FormatError(fmt::format("{} vertices (v) and {} faces (f), need some of both",
                                  vertices, faces));
  }
  CgalSoup soup;
  std::istringstream in(kept);
  (void)CGAL::IO::read_OBJ(in, soup.points, soup.polygons);  // counted below instead
  if (soup.points.size() != vertices) {
    throw FormatError(fmt::format("vertex {} of {} is not three finite numbers",
                                  soup.points.size() + 1, vertices));
  }
  if (soup.polygons.size() != faces) {
    throw FormatError(
        fmt::format("face {} of {} cannot be read", soup.polygons.size() + 1, faces));
  }
  return soup;
}

constexpr std::size_t kStlHeader = 84;
constexpr std::size_t kStlTriangle = 50;

std::size_t stl_count(const std::string& bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  return count;
}

// Binary by its size: some binary files start with "solid", and CGAL takes a text file
// that starts "solid<TAB>" for binary.
CgalSoup read_stl(std::string bytes) {
  static_assert(std::endian::native == std::endian::little);
  const bool binary = bytes.size() >= kStlHeader &&
                      bytes.size() == kStlHeader + kStlTriangle * stl_count(bytes);
  const bool text = bytes.rfind("solid", 0) == 0;
  if (!binary && !text) {
    if (bytes.size() < kStlHeader) {
      throw FormatError(
          fmt::format("{} bytes, neither text (\"solid\") nor a binary "
                      "header of 84",
                      bytes.size()));
    }
    throw FormatError(fmt::format(
        "cut short or not STL: the header announces {} triangles, {} bytes, "
        "but the file has {}",
        stl_count(bytes), kStlHeader + kStlTriangle * stl_count(bytes), bytes.size()));
  }
  // The first characters tell CGAL which of the two to read.
  bytes.replace(0, 6, binary ? "binary" : "solid ");
  CgalSoup soup;
  std::istringstream in(std::move(bytes));
  if (!CGAL::IO::read_STL(in, soup.points, soup.polygons)) {
    throw FormatError(
        fmt::format("cut short or not STL after {} triangles", soup.polygons.size()));
  }
  return soup;
}

CgalSoup read_ply(const std::string& bytes) {
  CgalSoup soup;
  std::istringstream in(bytes);
  if (!CGAL::IO::read_PLY(in, soup.points, soup.polygons, verbose(false))) {
    throw FormatError(
        fmt::format("cut short or not PLY after {} vertices and {} faces (faces need a "
                    "list vertex_indices of int or uint)",
                    soup.points.size(), soup.polygons.size()));
  }
  return soup;
}

CgalSoup read_off(const std::string& bytes) {
  CgalSoup soup;
  std::istringstream in(bytes);
  if (!CGAL::IO::read_OFF(in, soup.points, soup.polygons, verbose(false))) {
    throw FormatError("cut short or not OFF");
  }
  return soup;
}

CgalSoup read_format(std::string bytes, std::string_view extension) {
  if (extension == ".obj") {
    return read_obj(bytes);
  }
  if (extension == ".stl") {
    return read_stl(std::move(bytes));
  }
  if (extension == ".ply") {
    return read_ply(bytes);
  }
  if (extension == ".off") {
    return read_off(bytes);
  }
  throw FormatError(fmt::format("unknown extension \"{}\"", extension));
}

}  // namespace

PolygonSoup read_polygon_soup(std::string bytes, std::string_view extension) {
  CgalSoup read;
  try {
    read = read_format(std::move(bytes), extension);
  } catch (const Error&) {
    throw;
  } catch (const std::exception&) {  // bad_alloc from a wild count, CGAL's own
    throw FormatError(fmt::format("not a {} file", extension.substr(1)));
  }
  PolygonSoup soup;
  for (const Point& p : read.points) {
    soup.point.emplace_back(p.x(), p.y(), p.z());
  }
  soup.face = std::move(read.polygons);
  return soup;
}

}  // namespace palpate
