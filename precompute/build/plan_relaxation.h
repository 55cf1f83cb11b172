// What a build of materials that relax differently will take beside its presses.
#pragma once

#include "formats/scene/scene.h"
#include "precompute/build/plan.h"

namespace palpate {

/// Adds linear presses at every rate at which relaxation is fitted. Presses at one rate
/// take as long as those of the report until now, without its first work: reading the
/// body. Nothing where nodes do not differ.
void plan_relaxation(const Scene& scene, PlanReport& report);

}  // namespace palpate
