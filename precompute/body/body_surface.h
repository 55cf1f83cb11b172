// A body's surface made fit for its scene, or refused with what would help.
#pragma once

#include <string>
#include <vector>

#include "formats/mesh/surface_mesh.h"
#include "formats/scene/scene.h"
#include "precompute/surface/surface_check.h"
#include "precompute/tets/inner_surface.h"

namespace palpate {

/// Whether the scene presses a vertex there: free, and in the reach's box.
[[nodiscard]] bool is_reachable(const Scene& scene, const Eigen::Vector3d& p_m);

/// The body's mesh as the scene's file has it, without parts that are the surface of
/// one of its inclusions. Such a part lies inside another part and coincides with an
/// inclusion's mesh as faces are shared (formats/scene/SCENE.md).
/// @param notes gains what was found out about the file, and a line for each such part.
[[nodiscard]] SurfaceMesh read_body_mesh(const Scene& scene,
                                         std::vector<std::string>& notes);

/// Cavities of a body as inner surfaces, and what is left of its surface.
struct HollowBody {
  SurfaceMesh surface;               ///< its vertices and triangles keep their order
  std::vector<InnerSurface> cavity;  ///< "cavity 1" of the file and so on
};
[[nodiscard]] HollowBody take_cavities(const Scene& scene,
                                       const CheckedSurface& checked);

/// Halves edges where the scene reaches, until none is longer than an eighth of the
/// reach's diagonal. The reach is what its box and the body's share. Beyond the reach,
/// edges may grow by half of the distance. Only a surface without a vertex in reach is
/// refined, as a block of twelve triangles: it cannot be pressed as it is. Other
/// surfaces are left alone. Old vertices stay first and in place.
/// @param notes gains a line if the surface was refined.
[[nodiscard]] SurfaceMesh refined_for_reach(const Scene& scene, SurfaceMesh surface,
                                            std::vector<std::string>& notes);

/// @throws InputError naming a part of the surface that no support holds.
void require_held_parts(const Scene& scene, const CheckedSurface& checked);

}  // namespace palpate
