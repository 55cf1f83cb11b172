// palpate-run replay: renders a recorded run again and compares.
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/forms/open_stored.h"
#include "runtime/command/commands.h"
#include "runtime/run/replay.h"

namespace palpate {
namespace {

struct ReplayFlags {
  std::string recording;
  std::string database;
  std::string model;
  bool other_database = false;
  bool json = false;
};

nlohmann::json replay_json(const ReplayReport& r, const Recording& recording) {
  return {{"reproduced", r.is_reproduced()},
          {"model", name(r.model)},
          {"ticks", r.ticks},
          {"compared_ticks", r.compared},
          {"identical_ticks", r.identical},
          {"different_tick", r.different_tick},
          {"different_in", r.different_in},
          {"gap_tick", r.gap_tick},
          {"from_start", r.from_start},
          {"ended", recording.ended},
          {"ticks_dropped", recording.end.ticks_dropped},
          {"arrivals_dropped", recording.end.arrivals_dropped},
          {"force_rms_n", r.force_rms_n},
          {"force_difference_n", r.force_difference_n},
          {"force_difference_s", r.force_difference_s},
          {"torque_difference_n_m", r.torque_difference_n_m},
          {"force_max_n", r.force_max_n},
          {"replayed_max_n", r.replayed_max_n},
          {"net_energy_j", r.net_energy_j},
          {"replayed_net_j", r.replayed_net_j},
          {"dissipated_j", r.dissipated_j},
          {"replayed_dissipated_j", r.replayed_dissipated_j},
          {"recorded_fault", recording.end.fault},
          {"fault", name(r.fault)}};
}

// What the recording lacks, for people; "" if nothing.
std::string lacking(const Recording& recording) {
  const RecordingEnd& end = recording.end;
  if (!recording.ended) {
    return "the recording was cut short by the end of its writer\n";
  }
  if (end.ticks_dropped + end.arrivals_dropped == 0) {
    return "";
  }
  return fmt::format("the recorder dropped {} ticks and {} elements\n",
                     end.ticks_dropped, end.arrivals_dropped);
}

void replay_recording(const ReplayFlags& flags) {
  std::optional<LocalModel> model;
  if (!flags.model.empty()) {
    model = requested_model(flags.model);
  }
  const Recording recording = read_recording(flags.recording);
  if (!flags.other_database) {
    check_same_database(recording, database_sha256(flags.database), flags.database);
  }
  const ResponseDatabase database = read_database(flags.database);
  const bool exact = !model && !flags.other_database;
  const ReplayReport report =
      exact ? replay(recording, database)
            : render_again(recording, database,
                           model.value_or(fast_config(recording.header).model));
  if (flags.json) {
    fmt::print("{}\n", json_text(replay_json(report, recording), 2));
  } else {
    fmt::print("{}{}", summary(report, exact), lacking(recording));
  }
  if (exact && !report.is_reproduced()) {
    throw Difference(fmt::format("{}: not reproduced", flags.recording));
  }
}

}  // namespace

void add_replay_command(Command app) {
  Command command = app.add_subcommand(
      "replay", "Render a recorded run again, to the same bits, or differently.");
  const auto flags = std::make_shared<ReplayFlags>();
  command.add_option("recording", flags->recording, "Recording (HDF5)").required();
  command.add_option("database", flags->database, "Response database (HDF5 or flat)")
      .required();
  command.add_option("--model", flags->model,
                     "Render the trajectory with this local model instead");
  command.add_flag("--other-database", flags->other_database,
                   "Render the trajectory on a database that was not recorded");
  command.add_flag("--json", flags->json, "Print the report for programs");
  command.callback([flags] {
    replay_recording(*flags);
  });
}

}  // namespace palpate
