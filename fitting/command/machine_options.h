// What options state to a command of the machine: its frame, its clock, the press that
// counts.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "fitting/curve/frame_run.h"
#include "formats/base/command_line.h"
#include "formats/measurement/measurement_file.h"

namespace palpate {

struct MachineOptions {
  double frame_stiffness_n_per_m = std::numeric_limits<double>::quiet_NaN();
  double frame_stiffness_sd_n_per_m = std::numeric_limits<double>::quiet_NaN();
  std::string frame_run;
  MeasurementColumn time;
  std::string cycle;
};

void add_machine_options(Command command, MachineOptions& options);

/// The frame as stated, or of the run on a rigid plate; none where neither is stated.
/// @param read reads a file as the command reads its own.
/// @throws InputError for both, and as frame_of_run(), naming the file.
[[nodiscard]] std::optional<FrameRun> frame_of(
    const MachineOptions& options,
    const std::function<Measurement(const std::string&)>& read);

/// The column of --time-column, its unit the header's where none is stated.
/// @throws InputError for a unit without a column.
[[nodiscard]] std::optional<MeasurementColumn> given_time(
    const MachineOptions& options);

/// The press that --cycle names; of a single one all samples.
/// @throws InputError for several without --cycle.
/// @throws InputError for "all", and for a number beyond the last press.
[[nodiscard]] Measurement press_of(const MachineOptions& options,
                                   const Measurement& samples);

}  // namespace palpate
