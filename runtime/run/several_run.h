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

/// A coupling's spring is at most what the device feels: softens it where it must be,
/// and puts it into report.stiffness where it is less than the contacts.
/// @param report its options, stiffness, bounds and hold_s are set.
void soften_coupling(SimulationReport& report, const DeviceLimits& limits);

}  // namespace palpate
