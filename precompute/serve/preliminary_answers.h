// Answers for a hand that cannot wait: linear presses on coarse meshes.
#pragma once

#include <span>
#include <vector>

#include "formats/database/work_unit.h"
#include "formats/scene/scene.h"
#include "precompute/build/build_job.h"
#include "precompute/serve/work_board.h"

namespace palpate {

/// Elements over the contact are so many times larger than those of final answers.
inline constexpr double kPreliminaryTimesCoarser = 2.0;

/// Factor on the estimates of preliminary answers, chosen on a human liver. With it the
/// difference to full-accuracy solves is within the stated error at 95 % of nodes or
/// more (tests/bench/MEASURED.md).
inline constexpr double kPreliminaryErrorFactor = 3.0;

/// Neighbours that share a mesh, together all reachable vertices; none where parts are
/// cut out ([cutout]): its final answers are as quick.
[[nodiscard]] std::vector<PreliminaryGroup> preliminary_groups(const Scene& scene,
                                                               const BuildJob& job);

/// Linear presses of all tools at the vertices, on one mesh made for them. Responses'
/// error_relative is kPreliminaryErrorFactor times their estimate, or 1 where final
/// answers are nonlinear: how far a linear press is from those is not known. A vertex
/// that fails has no response.
[[nodiscard]] std::vector<WorkUnitNode> preliminary_answers(
    const Scene& scene, const BuildJob& job, std::span<const std::int32_t> vertices);

/// A pressed node as answers give it: with its estimate of error.
[[nodiscard]] WorkUnitNode answer_of(const Scene& scene, const BuildJob& job,
                                     const SharedTool& tool, const PressedNode& node);

}  // namespace palpate
