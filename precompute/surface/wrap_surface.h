// A new closed surface around an old one, whatever is wrong with that.
#pragma once

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// Wraps the triangles from outside (Portaneri et al. 2022), as a sheet that cannot
/// enter openings narrower than opening_m and keeps offset_m away. The result is
/// closed, manifold, without self-intersections. None of the old vertices is kept, and
/// cavities and parts inside are lost. A surface with a wide opening becomes a double
/// wall: close the opening before.
/// @param opening_m, offset_m [m] > 0.
[[nodiscard]] SurfaceMesh wrap_surface(const SurfaceMesh& mesh, double opening_m,
                                       double offset_m);

}  // namespace palpate
