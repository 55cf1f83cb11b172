#include "precompute/surface/surface_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include <Eigen/Geometry>

#include "formats/base/at.h"
#include "precompute/surface/disjoint_sets.h"
#include "precompute/surface/edge_key.h"

namespace palpate {
namespace {

bool all_edges_twice(const SurfaceMesh& mesh, const SurfacePart& part) {
  std::map<std::uint64_t, int> uses;
  for (const Eigen::Index t : part.triangle) {
    for (int j = 0; j < 3; ++j) {
      ++uses[edge_key({mesh.triangle(t, j), mesh.triangle(t, (j + 1) % 3)})];
    }
  }
  return std::all_of(uses.begin(), uses.end(), [](const auto& use) {
    return use.second == 2;
  });
}

void measure(const SurfaceMesh& mesh, SurfacePart& part) {
  const SurfaceMesh alone = part_mesh(mesh, part);
  part.closed = all_edges_twice(mesh, part);
  part.area_m2 = surface_area_m2(alone);
  part.volume_m3 = part.closed ? enclosed_volume_m3(alone) : 0.0;
  part.middle_m = bounding_box(alone).center();
}

void find_specks(std::vector<SurfacePart>& parts) {
  double area_m2 = 0.0;
  double volume_m3 = 0.0;
  for (const SurfacePart& part : parts) {
    area_m2 += part.area_m2;
    volume_m3 += std::abs(part.volume_m3);
  }
  double specks_m2 = 0.0;
  for (SurfacePart& part : parts) {
    part.speck = part.closed && volume_m3 > 0.0
                     ? std::abs(part.volume_m3) < kSpeckShare * volume_m3
                     : part.area_m2 < kSpeckShare * area_m2;
    specks_m2 += part.speck ? part.area_m2 : 0.0;
  }
  if (!(specks_m2 <= 10.0 * kSpeckShare * area_m2)) {
    for (SurfacePart& part : parts) {
      part.speck = false;
    }
  }
}

}  // namespace

SurfaceMesh part_mesh(const SurfaceMesh& mesh, const SurfacePart& part) {
  SurfaceMesh one;
  one.triangle.resize(std::ssize(part.triangle), 3);
  one.position_m.resize(3 * std::ssize(part.triangle), 3);
  for (std::int32_t t = 0; t < std::ssize(part.triangle); ++t) {
    for (int j = 0; j < 3; ++j) {
      one.triangle(t, j) = 3 * t + j;
      one.position_m.row(3 * t + j) =
          mesh.position_m.row(mesh.triangle(part.triangle[at(t)], j));
    }
  }
  return one;
}

SurfaceMesh of_triangles(const SurfaceMesh& mesh, std::vector<Eigen::Index> triangle) {
  std::sort(triangle.begin(), triangle.end());
  std::vector<std::int32_t> number(at(mesh.position_m.rows()), -1);
  for (const std::int32_t v : mesh.triangle(triangle, Eigen::all).reshaped()) {
    number[at(v)] = 0;
  }
  std::vector<Eigen::Index> kept;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == 0) {
      number[v] = static_cast<std::int32_t>(kept.size());
      kept.push_back(static_cast<Eigen::Index>(v));
    }
  }
  SurfaceMesh result{.position_m = mesh.position_m(kept, Eigen::all),
                     .triangle = mesh.triangle(triangle, Eigen::all)};
  for (std::int32_t& v : result.triangle.reshaped()) {
    v = number[at(v)];
  }
  return result;
}

std::vector<SurfacePart> surface_parts(const SurfaceMesh& mesh) {
  Partition joined(at(mesh.position_m.rows()));
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    joined.join(mesh.triangle(t, 0), mesh.triangle(t, 1));
    joined.join(mesh.triangle(t, 0), mesh.triangle(t, 2));
  }
  std::map<std::int32_t, std::size_t> number;
  std::vector<SurfacePart> parts;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    const auto [place, inserted] =
        number.try_emplace(joined.find(mesh.triangle(t, 0)), parts.size());
    if (inserted) {
      parts.emplace_back();
    }
    parts[place->second].triangle.push_back(t);
  }
  for (SurfacePart& part : parts) {
    measure(mesh, part);
  }
  find_specks(parts);
  return parts;
}

}  // namespace palpate
