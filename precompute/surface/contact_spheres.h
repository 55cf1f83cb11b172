// Spheres by which a rigid tool touches, found for its surface.
#pragma once

#include <cstddef>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// Spheres of one radius inside a surface, each of which touches it.
struct ContactSpheres {
  Points centre_m;               ///< (n x 3) [m]
  double radius_m = 0.0;         ///< [m]
  double largest_error_m = 0.0;  ///< [m] of a point of the surface to the spheres'
  double rms_error_m = 0.0;      ///< [m] the same over the surface
};

/// Places that are spread over the surface (each the farthest from those before it),
/// one radius below it along their faces' normals. Without a radius, that of 24 between
/// a hundredth and a half of the tool's size whose rms error is smallest.
/// @param tool closed, outside out. @param count [1, 64].
/// @param radius_m [m] >= 0; 0: choose one.
/// @throws InputError where the surface has no area.
[[nodiscard]] ContactSpheres contact_spheres(const SurfaceMesh& tool, std::size_t count,
                                             double radius_m);

}  // namespace palpate
