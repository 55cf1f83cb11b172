// What the holds of probes say of relaxation, as the database keeps it.
#pragma once

#include <span>
#include <vector>

#include "fitting/surface/probe.h"
#include "formats/response/relaxation.h"

namespace palpate {

/// A row for each probe, not a number where it has none; no rows where none has any.
[[nodiscard]] RunRelaxation run_relaxation(std::span<const SurfaceProbe> probes);

/// One for all nodes: two terms fitted to the median over the probes of what each one's
/// own terms let stay, at equal times up to the shortest hold, after a press at the
/// median speed: where press and hold of a probe were fitted together, its share is
/// multiplied by what that says of the two speeds; else it is its own press's. Holds
/// shorter than half
/// the median hold, and presses without a speed, are left out. Medians of the terms
/// themselves would not do: the two terms of a probe trade against each other. Empty
/// where no probe has any.
[[nodiscard]] ResponseRelaxation common_relaxation(
    const std::vector<const SurfaceProbe*>& probes);

}  // namespace palpate
