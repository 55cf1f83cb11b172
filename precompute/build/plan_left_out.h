// What a build does not compute, and why.
#pragma once

#include <string>
#include <vector>

#include "precompute/build/plan.h"
#include "precompute/press/scene_solver.h"

namespace palpate {

/// One line each. @param report with its counts filled in.
[[nodiscard]] std::vector<std::string> left_out_of(const Scene& scene,
                                                   const PressStrategy& strategy,
                                                   const PlanReport& report);

}  // namespace palpate
