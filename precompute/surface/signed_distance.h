// How far inside or outside of a closed surface a point lies.
#pragma once

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "formats/mesh/surface_search.h"

namespace palpate {

/// Owns what it needs; the surface must outlive it, and be closed and
/// counter-clockwise from outside. The sign is that of the angle-weighted normal of the
/// nearest face, edge or vertex (Baerentzen and Aanaes 2005).
class SignedDistance {
 public:
  explicit SignedDistance(const SurfaceMesh& surface);

  struct Place {
    double distance_m = 0.0;  ///< [m] below 0 inside
    Eigen::Vector3d outward;  ///< [-] unit, of the surface there, between its vertices'
  };

  /// Of a surface without triangles: infinitely far outside.
  [[nodiscard]] Place at_m(const Eigen::Vector3d& p_m) const;

 private:
  [[nodiscard]] Eigen::Vector3d face_normal(Eigen::Index triangle) const;

  const SurfaceMesh& surface_;
  SurfaceSearch search_;
  Points normal_;  // of the vertices
};

}  // namespace palpate
