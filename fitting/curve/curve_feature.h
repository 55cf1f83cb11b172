// What a curve does that a soft body's response does not: it falls, stands still or
// yields.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

enum class FeatureKind {
  kFall,     ///< the force falls: puncture, damage, a switch
  kPlateau,  ///< it stays: slope below a tenth of the mean over a tenth of the depth
  kKnee,     ///< its slope falls to less than half: damage, yield, slip
  kClipped,  ///< it stands at one reading, the largest: the sensor's range ends there
};

struct CurveFeature {
  FeatureKind kind = FeatureKind::kFall;
  double depth_m = 0.0;      ///< [m] beyond contact, where it begins
  double depth_end_m = 0.0;  ///< [m] where it ends
  double change = 0.0;  ///< [N] of a fall; [-] slope over the mean of a plateau, over
                        ///< the largest before of a knee; [N] the reading, clipped
};

/// "force_falls", "plateau", "knee", "force_clipped".
[[nodiscard]] std::string_view feature_name(FeatureKind kind) noexcept;

/// "the force falls by 1.2 N from 3.1 to 3.4 mm depth: puncture, damage or a switch"
[[nodiscard]] std::string describe(const CurveFeature& feature);

/// At most one of each kind, the largest. A fall counts beyond twice the noise and a
/// hundredth of the largest force. Plateau and knee compare the force over a tenth of
/// the depth with the force without them. Each counts where the force is less by more
/// than three times the noise. A plateau is no knee as well.
/// @param depth_m (n >= 2) even, from 0. @param force_n (n) the curve.
/// @param noise_sd_n of one sample.
[[nodiscard]] std::vector<CurveFeature> find_features(std::span<const double> depth_m,
                                                      std::span<const double> force_n,
                                                      double noise_sd_n);

/// Where samples stand at their largest force without any noise. There 8 or more in a
/// row have one reading over a fiftieth of the displacement. Elsewhere fewer than 5 of
/// 100 repeat the reading before.
/// @param displacement_m, force_n (n) in the samples' order.
[[nodiscard]] std::optional<CurveFeature> find_clipped_force(
    std::span<const double> displacement_m, std::span<const double> force_n);

}  // namespace palpate
