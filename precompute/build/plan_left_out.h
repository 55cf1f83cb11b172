// What a build does not compute, and why; where it is held.
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

/// How much of the surface each support got, one line each.
[[nodiscard]] std::vector<std::string> support_notes(const Scene& scene,
                                                     const SurfaceMesh& surface);

}  // namespace palpate
