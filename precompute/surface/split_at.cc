#include "precompute/surface/split_at.h"

#include <array>

namespace palpate {

SurfaceMesh split_at(const SurfaceMesh& mesh, const SurfacePoint& place) {
  SurfaceMesh split{mesh.position_m, mesh.triangle};
  const auto added = static_cast<std::int32_t>(mesh.position_m.rows());
  split.position_m.conservativeResize(added + 1, 3);
  split.position_m.row(added).setZero();
  for (int j = 0; j < 3; ++j) {
    split.position_m.row(added) +=
        place.area_coordinate(j) *
        mesh.position_m.row(mesh.triangle(place.triangle, j));
  }
  const auto append = [&](const std::array<std::int32_t, 3>& corner) {
    split.triangle.conservativeResize(split.triangle.rows() + 1, 3);
    split.triangle.row(split.triangle.rows() - 1) << corner[0], corner[1], corner[2];
  };
  // Across an edge that the place lies on, the neighbour is cut in two as well.
  const auto cut = [&](Eigen::Index t, int j) {
    const std::int32_t a = mesh.triangle(t, j);
    const std::int32_t b = mesh.triangle(t, (j + 1) % 3);
    const std::int32_t c = mesh.triangle(t, (j + 2) % 3);
    split.triangle.row(t) << a, added, c;
    append({added, b, c});
  };
  for (int j = 0; j < 3; ++j) {
    if (place.area_coordinate((j + 2) % 3) > 0.0) {
      continue;
    }
    const std::int32_t a = mesh.triangle(place.triangle, j);
    const std::int32_t b = mesh.triangle(place.triangle, (j + 1) % 3);
    cut(place.triangle, j);
    for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        if (mesh.triangle(t, k) == b && mesh.triangle(t, (k + 1) % 3) == a) {
          cut(t, k);
        }
      }
    }
    return split;
  }
  const Eigen::RowVector3i corner = mesh.triangle.row(place.triangle);
  split.triangle.row(place.triangle) << corner[0], corner[1], added;
  append({corner[1], corner[2], added});
  append({corner[2], corner[0], added});
  return split;
}

}  // namespace palpate
