// Parameters to start the joint fit of an insertion from.
#pragma once

#include "fitting/insertion/needle_events.h"

namespace palpate {

/// The curve before the first rupture: b + c max(z - z0, 0)^n, by a grid of z0 and n.
struct NeedleCurve {
  double coefficient = 0.0, exponent = 1.5, contact_m = 0.0, offset_n = 0.0;
};

/// @throws InputError where the force does not rise before the first rupture, or fewer
/// than kNeedlePartMin samples precede it.
[[nodiscard]] NeedleCurve start_curve(const NeedlePath& path,
                                      const RuptureSamples& first);

/// (parameters) of the model. Friction is from extractions or later passes where there
/// are any, else from the slope after ruptures.
[[nodiscard]] Eigen::VectorXd start_parameters(const NeedlePath& path,
                                               const NeedleSwitches& switches,
                                               const NeedleModel& model,
                                               const NeedleCurve& curve);

}  // namespace palpate
