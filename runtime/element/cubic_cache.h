// The part of a node's curve that the tool is in, ready to be evaluated at each tick.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "formats/response/curve_view.h"
#include "runtime/account/real.h"
#include "runtime/element/element_cache.h"

namespace palpate {

/// One interval of a curve, or what follows its last sample, as one polynomial. With
/// x = d - from, f = f_0 + x (m_0 + x (a + x b)), and the energy is its antiderivative.
/// The same function as CurveView::at there; no division.
struct CurvePiece {
  Real from_m = 0.0;  ///< [m] the piece holds for from < d <= to
  Real to_m = 0.0;
  Real force_n = 0.0;            ///< [N] f_0
  Real stiffness_n_per_m = 0.0;  ///< [N/m] m_0
  Real bend_n_per_m2 = 0.0;      ///< [N/m^2] a
  Real twist_n_per_m3 = 0.0;     ///< [N/m^3] b
  Real energy_j = 0.0;           ///< [J] energy at `from`
  bool extrapolated = false;     ///< beyond the last sample

  [[nodiscard]] bool holds(Real d) const noexcept { return d > from_m && d <= to_m; }

  [[nodiscard]] ElementSample at(Real d) const noexcept {
    const Real x = d - from_m;
    const Real m = stiffness_n_per_m;
    const Real a = bend_n_per_m2;
    const Real b = twist_n_per_m3;
    return {force_n + x * (m + x * (a + x * b)), m + x * (2.0 * a + x * (3.0 * b)),
            energy_j +
                x * (force_n + x * (0.5 * m + x * (a * (1.0 / 3.0) + x * (0.25 * b)))),
            extrapolated};
  }
};

/// The piece of a curve of two samples at least around d > 0 [m].
[[nodiscard]] CurvePiece piece_around(const ElementCurve& curve, Real d) noexcept;

/// The pieces in which the nodes of one element were evaluated last.
struct CurvePieces {
  int slot = -1;                ///< of the element in the cache; -1: none
  std::uint64_t stored_at = 0;  ///< which element that was
  std::array<CurvePiece, 3> node;
};

/// Forgets the pieces of another element than the one in `slot`.
inline void turn_to(CurvePieces& pieces, const ElementCache& cache, int slot) noexcept {
  const std::uint64_t stored_at = cache.stored_at[static_cast<std::size_t>(slot)];
  if (pieces.slot != slot || pieces.stored_at != stored_at) {
    pieces = {.slot = slot, .stored_at = stored_at, .node = {}};
  }
}

/// The response of node j at d > 0 [m]. @param pieces of this element; the node's is
/// changed where d has left it.
[[nodiscard]] inline ElementSample evaluate(CurvePieces& pieces,
                                            const ElementNode& node, std::size_t j,
                                            Real d) noexcept {
  CurvePiece& piece = pieces.node[j];
  if (!piece.holds(d)) {
    piece = piece_around(node.curve(), d);
  }
  return piece.at(d);
}

}  // namespace palpate
