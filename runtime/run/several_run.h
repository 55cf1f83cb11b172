// What a run of a tool of several contacts on a device needs beside what render_run.h
// does for one.
#pragma once

#include "formats/response/tool_shape.h"
#include "runtime/device/device.h"
#include "runtime/run/render_run.h"

namespace palpate {

/// @param in_memory whether its responses are. @throws InputError for what a run of
/// several contacts cannot do, and for a coupling of a tool that touches at one place.
void check_several(const ToolShape& tool, const SimulationOptions& options,
                   bool in_memory);

/// With a coupling its spring is what counts (coupling_margin()): softens it where it
/// must and may be, and puts it into report.stiffness.
/// @param report its options, bounds and hold_s are set. @throws InputError where it
/// must be softened and may not.
void soften_coupling(SimulationReport& report, const DeviceLimits& limits);

}  // namespace palpate
