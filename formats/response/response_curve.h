// A force-deflection response f(d) along one direction, with its exact energy.
//
// Stage: written by precompute/ and fitting/, stored in the response database
// (database/FORMAT.md), evaluated by the fast step of runtime/ at every tick.
#pragma once

#include <span>
#include <vector>

#include "formats/response/curve_view.h"

namespace palpate {

/// Largest slope of a curve on [0, depth_max] [N/m], at least 0; found in closed form.
[[nodiscard]] double stiffness_max_n_per_m(const CurveView& curve) noexcept;

/// Energy of the Hermite cubic over the interval [depth_m[i], depth_m[i + 1]] [J].
[[nodiscard]] double interval_energy_j(const CurveView& curve, std::size_t i) noexcept;

/// Shape-preserving C1 piecewise cubic through (depth, force) samples.
///
/// Slopes at inner samples are weighted harmonic means of the secants (Fritsch &
/// Butland 1984), at the ends one-sided three-point slopes. All slopes are limited to
/// [0, 3 secant] (Fritsch & Carlson 1980), so f rises wherever the samples rise and
/// never overshoots. CurveView evaluates it; E' = f holds to rounding, which the
/// passivity ledger relies on.
class ResponseCurve {
 public:
  /// @param depth_m  (n) [m], n >= 2, depth_m[0] = 0, strictly increasing, finite.
  /// @param force_n  (n) [N], force_n[0] = 0, finite; may fall (snap-through).
  /// @throws InputError naming the first offending sample and its value.
  ResponseCurve(std::span<const double> depth_m, std::span<const double> force_n);

  /// Evaluates f, f' and E at depth_m [m]. NaN gives NaN. Never allocates or throws.
  [[nodiscard]] ResponseSample at(double depth_m) const noexcept {
    return view().at(depth_m);
  }

  [[nodiscard]] CurveView view() const noexcept {
    return {depth_, force_, slope_, energy_};
  }

  [[nodiscard]] double depth_max_m() const noexcept { return depth_.back(); }

  /// Whether the force falls with depth between two samples (snap-through).
  [[nodiscard]] bool falls() const noexcept;

  /// Largest slope on [0, depth_max], for the sampling bound B > 2 T J (paper, eq. 8).
  [[nodiscard]] double stiffness_max_n_per_m() const noexcept { return stiffness_max_; }

 private:
  std::vector<double> depth_;   // (n) [m]
  std::vector<double> force_;   // (n) [N]
  std::vector<double> slope_;   // (n) [N/m] Hermite slopes m_i
  std::vector<double> energy_;  // (n) [J] energy stored up to sample i
  double stiffness_max_ = 0.0;  // [N/m]
};

}  // namespace palpate
