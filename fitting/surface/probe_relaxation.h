// What the holds of probes say of relaxation, as the database keeps it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "fitting/surface/probe.h"
#include "formats/database/response_database.h"
#include "formats/response/relaxation.h"
#include "formats/response/viscoelasticity.h"

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

/// How the material relaxes, as it is rendered: two terms fitted to the median over the
/// probes of what each one's press and hold, fitted together, say of it; times up to
/// the shortest hold. Curves are of a press at the median speed. Empty where less than
/// half of the comparable holds were fitted together with their press.
[[nodiscard]] Viscoelasticity common_viscoelasticity(
    const std::vector<const SurfaceProbe*>& probes);

/// The first tool's relaxation: what is rendered, else what the holds showed.
void keep_relaxation(const std::vector<const SurfaceProbe*>& probes,
                     ResponseDatabase& database);

/// For people, what holds showed and what is rendered, a line each. Either may be
/// empty.
[[nodiscard]] std::string relaxation_text(const ResponseRelaxation& shown,
                                          const Viscoelasticity& rendered);

}  // namespace palpate
