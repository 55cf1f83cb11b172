// What a build on parts that are cut out of the body will take.
#pragma once

#include <cstddef>
#include <span>

#include "precompute/build/plan.h"
#include "precompute/press/scene_solver.h"
#include "precompute/press/work_unit_solver.h"

namespace palpate {

/// Meshes the body to cut from, and presses a few groups of vertices, `workers` of them
/// side by side. Fills in the report's cost, tets and unknowns, and a note.
/// @param strategy with cut-outs. @param vertices reachable ones. @param units of them.
/// @throws as CutOutSolver.
void plan_cut_outs(const Scene& scene, const BodySource& body,
                   const PressStrategy& strategy,
                   std::span<const std::int32_t> vertices,
                   std::span<const WorkUnit> units, std::size_t workers,
                   Progress& progress, PlanReport& report);

}  // namespace palpate
