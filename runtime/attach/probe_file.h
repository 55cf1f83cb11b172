// A probe's recording: what it found and what it measured, for people, for the bounds
// on stiffness, and to be sent.
#pragma once

#include <filesystem>
#include <string>

#include "runtime/attach/probe.h"
#include "runtime/device/device.h"

namespace palpate {

/// JSON: format "palpate probe", version 1, every quantity with its unit in its name,
/// the pushes as they were measured. Says no names or serial numbers of people or
/// devices.
[[nodiscard]] std::string probe_json(const ProbeReport& report);
void write_probe(const std::filesystem::path& file, const ProbeReport& report);

/// @throws InputError for a file that cannot be read, FormatError for one that is no
/// probe or has values that cannot be.
[[nodiscard]] ProbeReport read_probe(const std::filesystem::path& file);

/// What it found, in lines for people.
[[nodiscard]] std::string probe_text(const ProbeReport& report);

/// Axes along which it was tried and nothing was found, with commas between them.
[[nodiscard]] std::string axes_not_found(const ProbeReport& report);

/// The limits of a device that was probed, of its worst axis and on the safe side of
/// what is not known. Damping and dry friction are less by twice their standard
/// deviations, the delay is more by its resolution. The step is the coarser one, and
/// forces are held for an exchange.
/// @param assumed for what was not found: the largest force, a damping that cannot be
/// distinguished from none; and, where they are worse, for axes_not_found().
[[nodiscard]] DeviceLimits probed_limits(const ProbeReport& report,
                                         const DeviceLimits& assumed);

}  // namespace palpate
