// One call of TetGen, by bytes, so that it can be made in a child process.
#pragma once

#include <vector>

#include "formats/surface_mesh.h"
#include "precompute/tetrahedralise.h"

namespace palpate {

/// Fills the surfaces, in the calling process, which TetGen may take down. The result
/// is for tetgen_unpack(), and says so if TetGen gave up.
/// @param surface all triangles, of the outer and of inner surfaces, of extent about 1:
///   TetGen's tolerances like that. @param scale the factor from metres that made it
///   so.
[[nodiscard]] std::vector<char> tetgen_run(const SurfaceMesh& surface,
                                           const TetOptions& options, double scale);

/// What tetgen_run() made, in metres: positions and tets, positive; nothing else.
/// @throws NumericalError with TetGen's reason; InputError if options.size asked for
///   more than options.tets_max.
[[nodiscard]] TetMesh tetgen_unpack(const std::vector<char>& bytes,
                                    const TetOptions& options, double scale);

/// Volume of the regular tet of an edge.
[[nodiscard]] double regular_tet_volume(double edge);

}  // namespace palpate
