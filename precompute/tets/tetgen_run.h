// One call of TetGen, by bytes, so that it can be made in a child process.
#pragma once

#include <span>
#include <vector>

#include "formats/base/error.h"
#include "formats/mesh/surface_mesh.h"
#include "precompute/tets/tetrahedralise.h"

namespace palpate {

/// What no other try mends: a surface that crosses itself, a limit that was reached.
class HopelessTry : public NumericalError {
 public:
  using NumericalError::NumericalError;
};

/// How one try goes about it. TetGen aborts on some sound surfaces, mostly while it
/// improves tets, and on others because facets lie in one plane to rounding.
struct TetTry {
  bool improved = true;  ///< poor dihedral angles are refined and swapped away
  bool graded = true;    ///< the ratio of radius and edge is kept
  /// [-] of the extent: vertices are moved by up to so much while tets are made, and
  /// put back after.
  double moved = 0.0;
};

/// What tetgen_run() is to fill.
/// @param surface [m] all triangles, of the outer and of inner surfaces.
/// @param scale the factor from metres that makes its extent about 1: TetGen's
///   tolerances like that.
[[nodiscard]] std::vector<char> tetgen_input(const SurfaceMesh& surface,
                                             const TetOptions& options, double scale,
                                             const TetTry& how);

/// Fills the surfaces, in the calling process, which TetGen may take down. The result
/// is for tetgen_unpack(), and says so if TetGen gave up.
[[nodiscard]] std::vector<char> tetgen_run(std::span<const char> input);

/// What tetgen_run() made, in metres: positions and tets, positive; nothing else.
/// @throws NumericalError with TetGen's reason (HopelessTry where the surface crosses
///   itself or the memory did not suffice); InputError if options.size asked for
///   more than options.tets_max.
[[nodiscard]] TetMesh tetgen_unpack(std::span<const char> bytes,
                                    const TetOptions& options, double scale);

/// Volume of the regular tet of an edge.
[[nodiscard]] double regular_tet_volume(double edge);

}  // namespace palpate
