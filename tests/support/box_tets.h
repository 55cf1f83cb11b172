// A structured box of tetrahedra, graded as a test wants it.
#pragma once

#include <vector>

#include "precompute/tets/tetrahedralise.h"

namespace palpate {

struct BoxTets {
  TetMesh tets;
  Triangles surface;  ///< counter-clockwise from outside
};

/// Six tets per cell (Kuhn) of the grid spanned by ascending coordinates [m].
[[nodiscard]] BoxTets box_tets(const std::vector<double>& x_m,
                               const std::vector<double>& y_m,
                               const std::vector<double>& z_m);

/// Coordinates from -half to half [m]: spacing `fine` within `inner` of zero, growing
/// by `growth` per cell outside. Symmetric; zero is one of them.
[[nodiscard]] std::vector<double> graded(double half_m, double inner_m, double fine_m,
                                         double growth);

}  // namespace palpate
