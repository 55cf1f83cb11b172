// The force across the body's normal along a slide, by frequency: what a finger feels
// as texture where the body has none.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "tests/peers/measures.h"

namespace palpate::peers {

/// A finger's texture begins there: slower changes are the body's shape.
constexpr double kRoughHz = 5.0;

/// Mean squares of a signal by frequency, of all components together.
struct MeanSquares {
  double step_hz = 0.0;              ///< between frequencies: one over the duration
  std::vector<double> mean_squares;  ///< [signal^2] at step_hz, 2 step_hz, ...

  /// The signal's root mean square from low_hz on, to below high_hz.
  [[nodiscard]] double rms(double low_hz, double high_hz) const;
};

/// Discrete Fourier transform of evenly spaced samples, faded in and out by a Hann
/// window w_i = (1 - cos(2 pi i / n)) / 2, of which
/// @f$ m_k = 2 |\sum_i w_i s_i e^{-2 \pi j k i / n}|^2 / (n \sum_i w_i^2) @f$.
/// A sine of a whole number of periods and amplitude a has a^2 / 2 in all, in the three
/// frequencies around its own. @param signal at least two @param interval_s > 0
[[nodiscard]] MeanSquares mean_squares(std::span<const Eigen::Vector3d> signal,
                                       double interval_s);

/// F - (F.n) n. @param outward unit normals, as many as forces.
[[nodiscard]] std::vector<Eigen::Vector3d> sideways_n(
    std::span<const Eigen::Vector3d> force_n, std::span<const Eigen::Vector3d> outward);

/// Of the sideways force between a hand's first and last dense true force. The truth is
/// known to half the rate of its samples and has nothing beyond.
struct Sideways {
  MeanSquares rendered;
  MeanSquares truth;
};

/// Without frequencies where the hand has less than three dense true forces, or they
/// are not evenly spaced.
[[nodiscard]] Sideways sideways(const RenderedHand& rendered);

/// Both from kRoughHz on; NaN: not known.
struct Roughness {
  double rendered_n = std::numeric_limits<double>::quiet_NaN();  ///< [N] rms
  double true_n = std::numeric_limits<double>::quiet_NaN();      ///< [N]
  /// [-] the former over the latter; NaN where the latter is below kSmoothN
  double ratio = std::numeric_limits<double>::quiet_NaN();
};
constexpr double kSmoothN = 1e-5;  ///< below, a ratio would be of roundings
[[nodiscard]] Roughness roughness(const Sideways& sideways);

}  // namespace palpate::peers
