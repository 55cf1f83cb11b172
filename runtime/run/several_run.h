// Preparation of runs with several contacts: their options, body and virtual coupling.
// prepared_run.h prepares runs of one contact.
#pragma once

#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "formats/response/tool_shape.h"
#include "runtime/device/device.h"
#include "runtime/run/prepared_run.h"
#include "runtime/slow/response_source.h"

namespace palpate {

/// @param several whether there are responses that couple. @throws InputError for what
/// a run of several contacts cannot do. Also for options of several contacts in a run
/// of a tool that touches at one place.
void check_several(const ToolShape& tool, const SimulationOptions& options,
                   bool several);

/// Tools of several contacts, or of two hands: `pressed` is what the first presses
/// alone. @param handed_out gets the tables that the run is fed by.
/// @throws InputError as coupled_set().
[[nodiscard]] PressedBody pressed_by_several(const ResponseSource& source,
                                             PressedBody pressed,
                                             const SimulationOptions& options,
                                             std::vector<TableElements*>& handed_out);

/// With a coupling its spring is what counts (coupling_margin()): softens it where it
/// must and may be, and puts it into report.stiffness.
/// @param report its options, bounds and hold_s are set. @throws InputError where it
/// must be softened and may not.
void soften_coupling(SimulationReport& report, const DeviceLimits& limits);

}  // namespace palpate
