// What the holds of probes say of relaxation, as the database keeps it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "fitting/surface/probe.h"
#include "fitting/surface/relaxation_field.h"
#include "formats/database/response_database.h"
#include "formats/response/relaxation.h"
#include "formats/response/viscoelasticity.h"

namespace palpate {

/// A row for each probe, not a number where it has none; no rows where none has any.
[[nodiscard]] RunRelaxation run_relaxation(std::span<const SurfaceProbe> probes);

/// One for all nodes: two terms fitted to a median over the probes. The median is of
/// what each probe's own terms let stay after a press at the median speed. Times are
/// the same for all probes, up to the shortest hold. Where press and hold of a probe
/// were fitted together, its share is multiplied by what that fit says of the two
/// speeds. Else the share is its own press's. Holds shorter than half the median hold,
/// and presses without a speed, are left out. Medians of the terms themselves would not
/// do: the two terms of a probe trade against each other. Empty where no probe has any.
[[nodiscard]] ResponseRelaxation common_relaxation(
    const std::vector<const SurfaceProbe*>& probes);

/// Those of comparable holds (as above) that were fitted together with their press;
/// none where that is less than half of them.
[[nodiscard]] std::vector<const SurfaceProbe*> held_with_press(
    const std::vector<const SurfaceProbe*>& probes);

/// How the material relaxes, as it is rendered: two terms fitted to a median over
/// held_with_press(). The median is of what each one's press and hold, fitted together,
/// say of the relaxation. Times are up to the shortest hold. Curves are of a press at
/// the median speed. Empty where there are none.
[[nodiscard]] Viscoelasticity common_viscoelasticity(
    const std::vector<const SurfaceProbe*>& probes);

/// The first tool's relaxation: what is rendered, by node where relaxation_field() is
/// taken and else in common; else what the holds showed.
RelaxationFieldReport keep_relaxation(const std::vector<const SurfaceProbe*>& probes,
                                      ResponseDatabase& database);

/// For people, what holds showed, what is rendered, and whether by a field, a line
/// each. Any may be empty.
[[nodiscard]] std::string relaxation_text(const ResponseRelaxation& shown,
                                          const Viscoelasticity& rendered,
                                          const RelaxationFieldReport& field);

}  // namespace palpate
