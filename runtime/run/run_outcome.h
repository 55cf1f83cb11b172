// What a tool says at the end of a run, and how it ends.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "runtime/run/render_run.h"

namespace palpate {

/// All of a report, for programs.
[[nodiscard]] nlohmann::json as_json(const SimulationReport& report);

/// Throws what of a report ends the tool with an error; returns if nothing does.
/// @throws DeviceError for a device that was lost or fell silent, NumericalError for
/// other faults, FormatError for a stream that broke. Also throws what the slow thread
/// threw, Interrupted, and whatever else the report holds against the run.
void throw_what_ended(const SimulationReport& report);

}  // namespace palpate
