// Work on a surface that may take the process down, done in another one.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

struct SurfaceAndCounts {
  SurfaceMesh mesh;
  std::vector<std::size_t> count;  ///< whatever the work has counted
  double lost_share = 0.0;         ///< [-] of what the old surface encloses
};

/// Knows no more than these, for it is called in another process.
using SurfaceWork = SurfaceAndCounts (*)(const SurfaceMesh& mesh, double parameter);

/// What `work` returns, made in a child process of at most 600 s and 8 GB.
/// @param what the start of the error's sentence, "repair".
/// @throws NumericalError "<what>: ..." if the work threw, ran out of its limits, or
/// took the child down. Also if the returned surface has no triangles, an index out of
/// range or a coordinate that is not finite.
[[nodiscard]] SurfaceAndCounts surface_in_child(std::string_view what, SurfaceWork work,
                                                const SurfaceMesh& mesh,
                                                double parameter);

}  // namespace palpate
