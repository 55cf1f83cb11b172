#include "formats/mesh/surface_reader.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/named_message.h"
#include "formats/base/units.h"
#include "formats/mesh/stl_reader.h"
#include "formats/mesh/triangulate_polygon.h"

namespace palpate {
namespace {

constexpr double kExtentMin = 1e-7;  // [m]
constexpr double kExtentMax = 1e3;   // [m]
// Bodies that a hand presses: others are told, for the unit may have slipped.
constexpr double kUsualExtentMin = 1e-4;  // [m]
constexpr double kUsualExtentMax = 10.0;  // [m]

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) {
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  const auto known =
      std::find(kSurfaceExtensions.begin(), kSurfaceExtensions.end(), extension);
  if (known == kSurfaceExtensions.end()) {
    throw InputError(fmt::format("{}: unknown mesh format \"{}\"; known: {}",
                                 file.string(), extension,
                                 fmt::join(kSurfaceExtensions, ", ")));
  }
  return extension;
}

void check_points(const PolygonSoup& soup, const std::string& name) {
  for (std::size_t v = 0; v < soup.point.size(); ++v) {
    if (!soup.point[v].allFinite()) {
      throw InputError(fmt::format("{}: vertex {} is at ({}, {}, {}), must be finite",
                                   name, v + 1, soup.point[v].x(), soup.point[v].y(),
                                   soup.point[v].z()));
    }
  }
}

void check_faces(const PolygonSoup& soup, const std::string& name) {
  for (std::size_t f = 0; f < soup.face.size(); ++f) {
    if (soup.face[f].size() < 3) {
      throw InputError(fmt::format("{}: face {} has {} corners, needs at least 3", name,
                                   f + 1, soup.face[f].size()));
    }
    for (const std::size_t corner : soup.face[f]) {
      if (corner >= soup.point.size()) {
        throw InputError(fmt::format(
            "{}: face {} has corner {}, allowed are 1 to {} vertices", name, f + 1,
            static_cast<std::ptrdiff_t>(corner) + 1, soup.point.size()));
      }
    }
  }
}

SurfaceMesh to_mesh(const PolygonSoup& soup, const std::string& name, double metres) {
  std::vector<std::array<std::size_t, 3>> triangles;
  constexpr std::size_t kCornersMax = 10'000;  // a second's work
  for (const auto& face : soup.face) {
    if (face.size() > kCornersMax) {
      throw InputError(
          fmt::format("{}: a face has {} corners, at most {} are cut into "
                      "triangles",
                      name, face.size(), kCornersMax));
    }
    std::vector<Eigen::Vector3d> corner;
    corner.reserve(face.size());
    for (const std::size_t v : face) {
      corner.push_back(soup.point[v]);
    }
    for (const auto& t : triangulate_polygon(corner)) {
      triangles.push_back({face[t[0]], face[t[1]], face[t[2]]});
    }
  }
  SurfaceMesh mesh;
  mesh.position_m.resize(std::ssize(soup.point), 3);
  for (std::size_t v = 0; v < soup.point.size(); ++v) {
    mesh.position_m.row(static_cast<Eigen::Index>(v)) =
        metres * soup.point[v].transpose();
  }
  mesh.triangle.resize(std::ssize(triangles), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t j = 0; j < 3; ++j) {
      mesh.triangle(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(j)) =
          static_cast<std::int32_t>(triangles[t][j]);
    }
  }
  return mesh;
}

void check_extent(const SurfaceMesh& mesh, const std::string& name,
                  std::string_view unit, std::vector<std::string>* notes) {
  const double extent_m = bounding_box(mesh).sizes().maxCoeff();
  if (!(extent_m >= kExtentMin && extent_m <= kExtentMax)) {
    throw InputError(
        fmt::format("{}: the body is {:.3g} m long with coordinates in {}, allowed are "
                    "{:g} to {:g} m",
                    name, extent_m, unit, kExtentMin, kExtentMax));
  }
  const bool usual = extent_m >= kUsualExtentMin && extent_m <= kUsualExtentMax;
  if (notes != nullptr && !usual) {
    notes->push_back(fmt::format(
        "{}: the body is {:.3g} m long with coordinates in {}, where {:g} to {:g} m is "
        "usual: is the length unit right (--length-unit, or length_unit)?",
        std::filesystem::path(name).filename().string(), extent_m, unit,
        kUsualExtentMin, kUsualExtentMax));
  }
}

}  // namespace

SurfaceMesh read_surface(const std::filesystem::path& file,
                         std::string_view length_unit,
                         std::vector<std::string>* notes) {
  const double metres = metres_per(length_unit);
  const std::string extension = extension_of(file);
  const std::string name = file.string();
  const std::string content = read_file(file);
  if (content.empty()) {
    throw InputError(fmt::format("{}: the file is empty", name));
  }
  PolygonSoup soup;
  try {
    soup = read_polygon_soup(content, extension);
  } catch (const FormatError& error) {
    throw FormatError(with_name(name, error.what()));
  }
  if (soup.point.empty() || soup.face.empty()) {
    throw InputError(fmt::format("{}: {} vertices and {} faces, need some of both",
                                 name, soup.point.size(), soup.face.size()));
  }
  for (const std::string& note : soup.note) {
    if (notes != nullptr) {
      notes->push_back(fmt::format("{}: {}", file.filename().string(), note));
    }
  }
  check_points(soup, name);
  check_faces(soup, name);
  SurfaceMesh mesh = to_mesh(soup, name, metres);
  check_extent(mesh, name, length_unit, notes);
  return mesh;
}

}  // namespace palpate
