#include "fitting/curve/curve_feature.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

namespace palpate {
namespace {

constexpr double kFallNoises = 2.0, kFallShare = 0.01;
constexpr double kWindow = 0.1;       // [-] of the depth
constexpr double kStillSlope = 0.1;   // [-] slope over the mean
constexpr double kGivesWay = 0.5;     // [-] slope over the largest before
constexpr double kForceShare = 0.05;  // [-] of the largest: before, it is the start
constexpr double kSlopeNoises = 3.0;
constexpr std::ptrdiff_t kClippedMin = 8;  // samples
constexpr double kClippedShare = 0.02;     // [-] of the displacement
constexpr double kRepeatedMax = 0.05;      // [-] of the other samples

struct Curve {
  std::span<const double> depth, force;
  double noise;
  std::size_t window;

  [[nodiscard]] double rise(std::size_t i) const {
    return force[i + window] - force[i];
  }
  [[nodiscard]] std::size_t windows() const { return force.size() - window; }
};

std::optional<CurveFeature> fall_of(const Curve& curve) {
  CurveFeature largest;
  std::size_t peak = 0;
  for (std::size_t i = 0; i < curve.force.size(); ++i) {
    peak = curve.force[i] > curve.force[peak] ? i : peak;
    if (const double fall = curve.force[peak] - curve.force[i]; fall > largest.change) {
      largest = {FeatureKind::kFall, curve.depth[peak], curve.depth[i], fall};
    }
  }
  const double most = *std::max_element(curve.force.begin(), curve.force.end());
  return largest.change > std::max(kFallNoises * curve.noise, kFallShare * most)
             ? std::optional(largest)
             : std::nullopt;
}

// The longest run of windows in which the force hardly rises or falls.
std::optional<CurveFeature> plateau_of(const Curve& curve) {
  // Rises are differences of force over a window. `mean` is the rise of a straight line
  // from zero to the largest force. A plateau rises less, by kSlopeNoises of the noise
  // at least.
  const double most = *std::max_element(curve.force.begin(), curve.force.end());
  const double mean =
      most * static_cast<double>(curve.window) /
      static_cast<double>(std::max<std::size_t>(1, curve.force.size() - 1));
  const double enough = mean - kSlopeNoises * curve.noise;
  const double falls = -std::max(kStillSlope * mean, kSlopeNoises * curve.noise);
  std::size_t begin = 0, length = 0, longest = 0, at = 0;
  double sum = 0.0, sum_longest = 0.0;
  for (std::size_t i = 0; i < curve.windows(); ++i) {
    const double rise = curve.rise(i);
    if (curve.force[i] > kForceShare * most && rise < kStillSlope * mean &&
        rise > falls && rise < enough) {
      begin = length == 0 ? i : begin;
      sum = length == 0 ? rise : sum + rise;
      if (++length > longest) {
        longest = length;
        at = begin;
        sum_longest = sum;
      }
    } else {
      length = 0;
    }
  }
  if (longest == 0) {
    return std::nullopt;
  }
  return CurveFeature{FeatureKind::kPlateau, curve.depth[at],
                      curve.depth[at + longest - 1 + curve.window],
                      sum_longest / static_cast<double>(longest) / mean};
}

// The window whose slope is the smallest share of the largest before it.
std::optional<CurveFeature> knee_of(const Curve& curve) {
  CurveFeature sharpest{FeatureKind::kKnee, 0.0, 0.0, kGivesWay};
  std::size_t steepest = 0;
  for (std::size_t i = 0; i < curve.windows(); ++i) {
    steepest = curve.rise(i) > curve.rise(steepest) ? i : steepest;
    const double before = curve.rise(steepest), here = curve.rise(i);
    if (here < sharpest.change * before && before - here > kSlopeNoises * curve.noise) {
      sharpest.change = here / before;
      sharpest.depth_m = curve.depth[steepest + curve.window];
      sharpest.depth_end_m = curve.depth[i];
    }
  }
  if (!(sharpest.change < kGivesWay)) {
    return std::nullopt;
  }
  sharpest.depth_end_m = std::max(sharpest.depth_m, sharpest.depth_end_m);
  return sharpest;
}

}  // namespace

std::string_view feature_name(FeatureKind kind) noexcept {
  return kind == FeatureKind::kFall      ? "force_falls"
         : kind == FeatureKind::kPlateau ? "plateau"
         : kind == FeatureKind::kKnee    ? "knee"
                                         : "force_clipped";
}

std::string describe(const CurveFeature& feature) {
  const double from = 1e3 * feature.depth_m, to = 1e3 * feature.depth_end_m;
  switch (feature.kind) {
    case FeatureKind::kFall:
      return fmt::format(
          "the force falls by {:.3g} N from {:.3g} to {:.3g} mm depth: puncture, "
          "damage "
          "or a switch",
          feature.change, from, to);
    case FeatureKind::kPlateau:
      return fmt::format(
          "plateau from {:.3g} to {:.3g} mm depth: slope {:.2g} of the mean", from, to,
          feature.change);
    case FeatureKind::kClipped:
      return fmt::format(
          "the force stands at {:.4g} N from {:.3g} to {:.3g} mm depth, without noise: "
          "clipped, the sensor's range may end there",
          feature.change, from, to);
    case FeatureKind::kKnee:
      break;
  }
  return fmt::format(
      "knee at {:.3g} mm depth: the slope falls to {:.2g} of what it was", from,
      feature.change);
}

std::vector<CurveFeature> find_features(std::span<const double> depth_m,
                                        std::span<const double> force_n,
                                        double noise_sd_n) {
  const Curve curve{
      depth_m, force_n, noise_sd_n,
      std::max<std::size_t>(1, static_cast<std::size_t>(
                                   kWindow * static_cast<double>(depth_m.size() - 1)))};
  std::vector<CurveFeature> features;
  for (const auto& found : {fall_of(curve), plateau_of(curve)}) {
    if (found) {
      features.push_back(*found);
    }
  }
  if (const auto knee = features.empty() ? knee_of(curve) : std::nullopt) {
    features.push_back(*knee);
  }
  return features;
}

std::optional<CurveFeature> find_clipped_force(std::span<const double> displacement_m,
                                               std::span<const double> force_n) {
  if (force_n.empty()) {
    return std::nullopt;
  }
  // The longest run of samples that equal the largest force. Equal neighbours elsewhere
  // mean a coarse resolution, not a clipped force.
  const double most = *std::max_element(force_n.begin(), force_n.end());
  std::ptrdiff_t longest = 0, length = 0, end = 0, repeated = 0;
  for (std::ptrdiff_t i = 0; i < std::ssize(force_n); ++i) {
    const auto at = static_cast<std::size_t>(i);
    repeated += i > 0 && force_n[at] == force_n[at - 1] && force_n[at] != most ? 1 : 0;
    length = force_n[at] == most ? length + 1 : 0;
    if (length > longest) {
      longest = length;
      end = i;
    }
  }
  const auto others = static_cast<double>(std::ssize(force_n) - longest);
  if (longest < kClippedMin || static_cast<double>(repeated) > kRepeatedMax * others) {
    return std::nullopt;
  }
  const auto [low, high] =
      std::minmax_element(displacement_m.begin(), displacement_m.end());
  const double from = displacement_m[static_cast<std::size_t>(end - longest + 1)];
  const double to = displacement_m[static_cast<std::size_t>(end)];
  return to - from > kClippedShare * (*high - *low)
             ? std::optional(CurveFeature{FeatureKind::kClipped, from, to, most})
             : std::nullopt;
}

}  // namespace palpate
