// What the coupling of contacts will take beside a build's presses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/scene/scene.h"
#include "precompute/body/scene_body.h"
#include "precompute/build/plan.h"

namespace palpate {

/// Adds the table of compliance, whose work and memory are counted. Also adds the joint
/// presses that measure the table's error, of which every worker tries one set. The
/// memory that these presses take at once is that of a build. Nothing where no tool
/// couples.
/// @param report its peak_memory_bytes is at least the table's afterwards.
void plan_coupling(const Scene& scene, const BodySource& body,
                   std::span<const std::int32_t> reachable, std::size_t workers,
                   Progress& progress, PlanReport& report);

}  // namespace palpate
