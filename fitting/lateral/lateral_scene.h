// What a lateral fit found, as keys of a scene's tool (formats/scene/SCENE.md).
#pragma once

#include <string>

#include "fitting/numerics/interval_estimate.h"

namespace palpate {

/// TOML: `friction` and `presliding_m` of a [[tool]], to which a scene adds name, shape
/// and lengths. A presliding length that was refused has a comment with the reason.
/// @throws InputError where the friction coefficient was refused.
[[nodiscard]] std::string lateral_scene(const IntervalEstimate& friction,
                                        const IntervalEstimate& presliding_m);

}  // namespace palpate
