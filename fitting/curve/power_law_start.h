// Starting points for the joint fit of baseline and contact. The starting points are
// cheap, and good enough that one of them lies in the valley of the best fit.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace palpate {

/// A curve in its own scale: displacement from 0 to 1, force over its range.
struct ScaledCurve {
  std::vector<double> x;            ///< (n) [-]
  std::vector<double> f;            ///< (n) [-]
  std::vector<double> weight = {};  ///< (n) [-] (0, 1] of the residuals; none: all 1
  double contact_min = 0.0;         ///< [-] [0, 1) what is before is surely free
  double drift_weight = 0.0;        ///< [-] of one more residual, the baseline's slope
};

/// f = baseline_force + baseline_slope x + coefficient max(x - contact, 0)^exponent
struct ContactModel {
  double baseline_force = 0.0;  ///< [-]
  double baseline_slope = 0.0;  ///< [-]
  double contact = 0.0;         ///< [-] [0, 1]
  double exponent = 1.0;        ///< [-] [1, 4]
  double coefficient = 0.0;     ///< [-] > 0
};

/// Some of the samples, all else as it is. @param which of [0, n).
[[nodiscard]] ScaledCurve samples_of(const ScaledCurve& curve,
                                     const std::vector<std::size_t>& which);

/// Every k-th sample, so that ranking a long curve costs no more than a short one:
/// fewer than twice kThinnedSamples.
constexpr std::size_t kThinnedSamples = 400;
[[nodiscard]] ScaledCurve thinned(const ScaledCurve& curve);

/// Where the force leaves the line through the first fifth of the samples by 5 standard
/// deviations for three samples. Late by nature; empty if it never does.
[[nodiscard]] std::optional<double> deviation_from_baseline(const ScaledCurve& curve);

/// Where the force's variance in a window after a sample is largest relative to that
/// before it.
[[nodiscard]] double ratio_of_variances(const ScaledCurve& curve);

/// The best models over a grid of contact points (and those of the detectors) and
/// exponents, the other parameters by linear least squares. Best first, at most
/// `count`, contact points at least 0.05 apart. @param exponent the only one to try.
[[nodiscard]] std::vector<ContactModel> contact_starts(const ScaledCurve& curve,
                                                       std::optional<double> exponent,
                                                       std::size_t count);

}  // namespace palpate
