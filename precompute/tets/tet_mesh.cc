#include "precompute/tets/tet_mesh.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "formats/mesh/angle_between.h"

namespace palpate {
namespace {

Eigen::Vector3d tet_corner_m(const TetMesh& mesh, Eigen::Index t, int j) {
  return mesh.position_m.row(mesh.tet(t, j)).transpose();
}

// Angle between the two faces at edge (i, j), from their parts across it.
double dihedral_rad(const TetMesh& mesh, Eigen::Index t, int i, int j) {
  const int k = i != 0 && j != 0 ? 0 : (i != 1 && j != 1 ? 1 : 2);
  const int l = 6 - i - j - k;
  const Eigen::Vector3d p = tet_corner_m(mesh, t, i);
  const Eigen::Vector3d edge = tet_corner_m(mesh, t, j) - p;
  const Eigen::Vector3d u = edge.cross(tet_corner_m(mesh, t, k) - p);
  const Eigen::Vector3d v = edge.cross(tet_corner_m(mesh, t, l) - p);
  return angle_between(u, v);
}

}  // namespace

double tet_volume_m3(const TetMesh& mesh, Eigen::Index t) {
  const Eigen::Vector3d a = tet_corner_m(mesh, t, 0);
  return (tet_corner_m(mesh, t, 1) - a)
             .cross(tet_corner_m(mesh, t, 2) - a)
             .dot(tet_corner_m(mesh, t, 3) - a) /
         6.0;
}

double tet_shape(const TetMesh& mesh, Eigen::Index t) {
  double longest_m = 0.0;
  for (int i = 1; i < 4; ++i) {
    for (int j = 0; j < i; ++j) {
      longest_m = std::max(
          longest_m, (tet_corner_m(mesh, t, i) - tet_corner_m(mesh, t, j)).norm());
    }
  }
  return 6.0 * std::numbers::sqrt2 * tet_volume_m3(mesh, t) /
         (longest_m * longest_m * longest_m);
}

TetQuality tet_quality(const TetMesh& mesh) {
  TetQuality quality{.smallest_volume_m3 = std::numeric_limits<double>::infinity(),
                     .smallest_dihedral_rad = std::numbers::pi};
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    const double volume_m3 = tet_volume_m3(mesh, t);
    quality.volume_m3 += volume_m3;
    quality.smallest_volume_m3 = std::min(quality.smallest_volume_m3, volume_m3);
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) {
        const double angle = dihedral_rad(mesh, t, i, j);
        quality.smallest_dihedral_rad = std::min(quality.smallest_dihedral_rad, angle);
        quality.largest_dihedral_rad = std::max(quality.largest_dihedral_rad, angle);
      }
    }
  }
  return quality;
}

}  // namespace palpate
