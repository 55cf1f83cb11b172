// All that a scene's computation is before anything is pressed: its body, how nodes are
// pressed, and the units of work. The same for every process that takes part.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/database/work_unit.h"
#include "formats/scene/scene.h"
#include "precompute/body/scene_body.h"
#include "precompute/press/scene_solver.h"
#include "precompute/press/work_unit_solver.h"

namespace palpate {

struct JobOptions {
  RepairMode repair = RepairMode::kOff;  ///< of the body's mesh file
  bool solve_all = false;                ///< every node, none interpolated
};

struct BuildJob {
  BodySource body;
  std::vector<std::int32_t> reachable;  ///< vertices, ascending
  PressStrategy strategy;
  std::vector<WorkUnit> units;
  JobDescription plan;  ///< its digest is of everything that outcomes depend on
};

/// @throws InputError as read_body(), reachable_vertices() and choose_strategy().
[[nodiscard]] BuildJob build_job(const Scene& scene, const JobOptions& options);

}  // namespace palpate
