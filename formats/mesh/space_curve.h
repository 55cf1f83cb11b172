// Hilbert's curve through a box: points that are near in this order are near in space.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// Bits of each coordinate that the order tells apart: 0.1 um of a body of 0.2 m.
constexpr int kCurveBits = 21;

/// Place along the curve of a cell of a (2^21)^3 grid, a bijection onto [0, 2^63).
/// Successive places are cells that share a face (Skilling, "Programming the Hilbert
/// curve", 2004). @param cell each in [0, 2^21).
[[nodiscard]] std::uint64_t hilbert_place(
    const Eigen::Matrix<std::uint32_t, 3, 1>& cell);

/// (n) point indices in the order of the curve through the points' bounding cube;
/// points of one cell keep their order. @param points (n x 3); what is not finite lies
/// somewhere in the order.
[[nodiscard]] std::vector<std::int32_t> curve_order(const Points& points);

}  // namespace palpate
