// Local refinement of a surface by longest-edge bisection.
#pragma once

#include <functional>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// Wanted edge length [m] at a point.
using EdgeLength = std::function<double(const Eigen::Vector3d&)>;

/// Halves edges until none is longer than `edge_m` at its middle. The surface stays the
/// same point set: new vertices lie on old edges, old vertices keep their indices and
/// places. A triangle is only ever cut across its longest edge. So its angles stay
/// above half of the smallest angle of the original triangle (Rivara, Int. J. Numer.
/// Meth. Eng. 20, 1984). Same input, same result.
/// @param triangles_max once a pass has more triangles than this the refinement ends as
/// it is.
/// @throws InputError if `edge_m` asks for a length that is not positive.
[[nodiscard]] SurfaceMesh refine_longest_edge(const SurfaceMesh& surface,
                                              const EdgeLength& edge_m,
                                              Eigen::Index triangles_max);

}  // namespace palpate
