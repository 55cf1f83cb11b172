#include "fitting/command/machine_options.h"

#include <fmt/format.h>

#include "fitting/curve/press_cycles.h"
#include "fitting/curve/split_presses.h"
#include "formats/base/error.h"
#include "formats/base/named_message.h"

namespace palpate {

void add_machine_options(Command command, MachineOptions& options) {
  command.add_option("--frame-stiffness-n-per-m", options.frame_stiffness_n_per_m,
                     "N/m of the machine's frame, whose deflection is taken off");
  command.add_option("--frame-stiffness-sd-n-per-m", options.frame_stiffness_sd_n_per_m,
                     "its standard deviation, N/m");
  command.add_option("--frame-run", options.frame_run,
                     "instead: a run on a rigid plate, columns as FILE");
  command.add_option("--time-column", options.time.column,
                     "name or number: a drift with time is then looked for");
  command.add_option("--time-unit", options.time.unit,
                     "s, ms, us, ns; default: the header's");
  command.add_option("--cycle", options.cycle,
                     "of several presses the first, last or the one of this number");
}

std::optional<FrameRun> frame_of(
    const MachineOptions& options,
    const std::function<Measurement(const std::string&)>& read) {
  const bool stated =
      options.frame_stiffness_n_per_m == options.frame_stiffness_n_per_m;
  const bool with_sd =
      options.frame_stiffness_sd_n_per_m == options.frame_stiffness_sd_n_per_m;
  if (stated && !options.frame_run.empty()) {
    throw InputError("--frame-stiffness-n-per-m and --frame-run: tell one of them");
  }
  if (with_sd && !stated) {
    throw InputError(
        "--frame-stiffness-sd-n-per-m goes with --frame-stiffness-n-per-m");
  }
  if (stated) {
    FrameRun frame;
    frame.frame = linear_frame(options.frame_stiffness_n_per_m,
                               options.frame_stiffness_sd_n_per_m);
    return frame;
  }
  if (options.frame_run.empty()) {
    return std::nullopt;
  }
  const Measurement samples = read(options.frame_run);
  try {
    return frame_of_run(samples);
  } catch (const InputError& error) {
    throw InputError(with_name(options.frame_run, error.what()));
  }
}

std::optional<MeasurementColumn> told_time(const MachineOptions& options) {
  if (options.time.column.empty()) {
    if (!options.time.unit.empty()) {
      throw InputError("--time-unit goes with --time-column");
    }
    return std::nullopt;
  }
  return MeasurementColumn{options.time.column, options.time.unit.empty()
                                                    ? kUnitFromHeader
                                                    : options.time.unit};
}

Measurement press_of(const MachineOptions& options, const Measurement& samples) {
  if (options.cycle.empty()) {
    if (const std::size_t count = split_presses(samples).size(); count > 1) {
      throw InputError(
          fmt::format("holds {} presses one after another; choose one by --press 1 to "
                      "{}, or by --cycle first or last",
                      count, count));
    }
    return samples;
  }
  const CycleChoice choice = parse_cycle(options.cycle);
  if (choice.kind == CycleChoice::Kind::kAll) {
    throw InputError(
        "--cycle all: curve fits one press; palpate-fit batch fits all of a file");
  }
  const auto presses = split_presses(samples);
  return presses.at(chosen_cycles(choice, presses.size()).front() - 1);
}

}  // namespace palpate
