// Evaluation of a stored force-deflection curve. Header only, no allocation, so that
// the fast step, the tools and the tests evaluate by the same few lines.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace palpate {

/// Force, slope and energy of a response at one depth.
template <typename Scalar>
struct BasicResponseSample {
  Scalar force_n = 0.0;            ///< [N] f(d)
  Scalar stiffness_n_per_m = 0.0;  ///< [N/m] f'(d)
  Scalar energy_j = 0.0;           ///< [J] integral of f from 0 to d
  bool extrapolated = false;       ///< d lies beyond the last sample
};

/// A C1 piecewise cubic through samples that somebody else owns.
///
/// The interval [d_i, d_{i+1}] has width h, and t = (d - d_i)/h. There f is the cubic
/// Hermite polynomial of f_i, f_{i+1} and the slopes m_i, m_{i+1}. The energy is the
/// antiderivative of the same polynomial, so E' = f to rounding. Zero for d <= 0.
/// Beyond the last depth the curve is linear with the slope max(0, m) of the last
/// sample. A curve that falls at its end holds its force: going on falling would pull
/// the tool in, with an energy below zero. An empty view is a response of zero.
template <typename Scalar>
struct BasicCurveView {
  std::span<const Scalar> depth_m;            ///< (n) [m] from 0, strictly increasing
  std::span<const Scalar> force_n;            ///< (n) [N] from 0
  std::span<const Scalar> stiffness_n_per_m;  ///< (n) [N/m] Hermite slopes
  std::span<const Scalar> energy_j;           ///< (n) [J] energy up to each sample

  [[nodiscard]] Scalar depth_max_m() const noexcept {
    return depth_m.empty() ? 0.0 : depth_m.back();
  }

  /// f, f' and E at d [m]. NaN gives NaN.
  [[nodiscard]] BasicResponseSample<Scalar> at(Scalar d) const noexcept {
    if (depth_m.empty() || d <= 0.0) {
      return {};
    }
    const std::size_t n = depth_m.size();
    if (d > depth_m[n - 1]) {
      const Scalar past = d - depth_m[n - 1];
      const Scalar m = std::max(Scalar(0.0), stiffness_n_per_m[n - 1]);
      return {force_n[n - 1] + m * past, m,
              energy_j[n - 1] + (force_n[n - 1] + 0.5 * m * past) * past, true};
    }
    return inside(interval(d), d);
  }

  /// The interval i with d_i < d <= d_{i+1}; the first or last one beyond the ends.
  /// Two samples at least.
  [[nodiscard]] std::size_t interval(Scalar d) const noexcept {
    const auto upper = std::lower_bound(depth_m.begin() + 1, depth_m.end() - 1, d);
    return static_cast<std::size_t>(upper - depth_m.begin()) - 1;
  }

  /// f, f' and E by the cubic of interval i.
  [[nodiscard]] BasicResponseSample<Scalar> inside(std::size_t i,
                                                   Scalar d) const noexcept {
    const Scalar h = depth_m[i + 1] - depth_m[i];
    const Scalar t = (d - depth_m[i]) / h;
    // f = f0 + h (m0 t + c2 t^2 + c3 t^3)
    const Scalar f0 = force_n[i];
    const Scalar m0 = stiffness_n_per_m[i];
    const Scalar m1 = stiffness_n_per_m[i + 1];
    const Scalar s = (force_n[i + 1] - f0) / h;
    const Scalar c2 = 3.0 * s - 2.0 * m0 - m1;
    const Scalar c3 = m0 + m1 - 2.0 * s;
    return {
        f0 + h * t * (m0 + t * (c2 + t * c3)), m0 + t * (2.0 * c2 + t * 3.0 * c3),
        energy_j[i] + h * t * (f0 + h * t * (m0 / 2.0 + t * (c2 / 3.0 + t * c3 / 4.0))),
        false};
  }
};

using ResponseSample = BasicResponseSample<double>;
using CurveView = BasicCurveView<double>;

}  // namespace palpate
