#include "runtime/run/contact_replay.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "runtime/run/pose_trace.h"

namespace palpate {
namespace {

using Index = Eigen::Index;

std::vector<PoseTick> poses_of(const ContactRecording& r) {
  std::vector<PoseTick> ticks(r.time_s.size());
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ticks[i].time_s = r.time_s[i];
    for (Index hand = 0; hand < r.hands(); ++hand) {
      const Eigen::Matrix<double, 7, 1> pose =
          r.pose.row(static_cast<Index>(i)).segment<7>(7 * hand).transpose();
      ticks[i].pose[static_cast<std::size_t>(hand)] = {
          pose.head<3>(), Eigen::Quaterniond(pose(6), pose(3), pose(4), pose(5))};
    }
  }
  return ticks;
}

// Of hand and tick.
Eigen::Matrix<double, 6, 1> wrench_of(const PoseTick& tick, std::size_t hand) {
  Eigen::Matrix<double, 6, 1> v;
  v << tick.command.wrench[hand].force_n, tick.command.wrench[hand].torque_n_m;
  return v;
}

bool same_energies(const ContactRecording& r, std::size_t i, const PoseTick& tick) {
  const CoupledCommand& c = tick.command;
  return r.contacts[i] == c.contacts && r.depth_m[i] == c.depth_m &&
         r.work_j[i] == tick.work_j && r.stored_j[i] == c.stored_j &&
         r.tank_j[i] == c.tank_j && r.dissipated_j[i] == c.dissipated_j;
}

// Notes how far row i is off. @returns whether it is not at all.
bool compare(const ContactRecording& r, std::size_t i, const PoseTick& tick,
             ContactReplayReport& report) {
  bool same = same_energies(r, i, tick);
  for (std::size_t hand = 0; hand < r.tools.size(); ++hand) {
    const Eigen::Matrix<double, 6, 1> off =
        wrench_of(tick, hand) - r.wrench.row(static_cast<Index>(i))
                                    .segment<6>(6 * static_cast<Index>(hand))
                                    .transpose();
    report.force_difference_n =
        std::max(report.force_difference_n, off.head<3>().norm());
    report.torque_difference_n_m =
        std::max(report.torque_difference_n_m, off.tail<3>().norm());
    same = same && off.isZero(0.0);
  }
  return same;
}

LocalModel field_of(const ContactRecording& recording) {
  const auto model = local_model(recording.model);
  if (!model || !is_field(*model)) {
    throw FormatError(fmt::format(
        "recording: model {:?} does not render several contacts", recording.model));
  }
  return *model;
}

}  // namespace

ContactRecording contact_recording(const ContactRunReport& run,
                                   const std::string& database,
                                   const std::string& sha256) {
  ContactRecording r;
  r.writer = "palpate-run " PALPATE_VERSION;
  r.database = database;
  r.database_sha256 = sha256;
  r.tools = run.tools;
  r.model = name(run.options.model);
  r.fast_hz = run.options.fast_hz;
  r.slow_hz = run.options.slow_hz;
  r.force_scale = run.force_scale;
  r.force_max_n = run.options.force_max_n;
  r.ramp_s = run.options.ramp_s;
  r.fault = name(run.fault);
  const auto rows = static_cast<Index>(run.kept.size());
  r.pose.resize(rows, 7 * r.hands());
  r.wrench.resize(rows, 6 * r.hands());
  for (Index i = 0; i < rows; ++i) {
    const PoseTick& tick = run.kept[static_cast<std::size_t>(i)];
    r.time_s.push_back(tick.time_s);
    for (std::size_t hand = 0; hand < r.tools.size(); ++hand) {
      const auto at = static_cast<Index>(hand);
      r.pose.row(i).segment<3>(7 * at) = tick.pose[hand].position_m.transpose();
      r.pose.row(i).segment<4>(7 * at + 3) = tick.pose[hand].turn.coeffs().transpose();
      r.wrench.row(i).segment<6>(6 * at) = wrench_of(tick, hand).transpose();
    }
    r.contacts.push_back(tick.command.contacts);
    r.depth_m.push_back(tick.command.depth_m);
    r.work_j.push_back(tick.work_j);
    r.stored_j.push_back(tick.command.stored_j);
    r.tank_j.push_back(tick.command.tank_j);
    r.dissipated_j.push_back(tick.command.dissipated_j);
  }
  return r;
}

ContactReplayReport replay_contacts(const ContactRecording& recording,
                                    const ResponseDatabase& database) {
  if (recording.time_s.empty()) {
    throw InputError("the recording has no ticks: nothing to render again");
  }
  ContactRunOptions options;
  options.tools = recording.tools;
  options.model = field_of(recording);
  options.fast_hz = recording.fast_hz;
  options.slow_hz = recording.slow_hz;
  options.force_max_n = recording.force_max_n;
  options.ramp_s = recording.ramp_s;
  options.force_scale = recording.force_scale;
  options.given = poses_of(recording);
  options.keep = true;
  const std::atomic<bool> stop = false;
  const ContactRunReport run = simulate_contacts(database, options, stop);
  ContactReplayReport report;
  report.ticks = static_cast<std::int64_t>(recording.time_s.size());
  report.net_energy_j = recording.work_j.back();
  report.replayed_net_j = run.model_work_j;
  report.fault = run.fault;
  for (std::size_t i = 0; i < recording.time_s.size(); ++i) {
    const bool same = i < run.kept.size() && compare(recording, i, run.kept[i], report);
    report.identical += same ? 1 : 0;
    if (!same && report.different_tick < 0) {
      report.different_tick = static_cast<std::int64_t>(i);
    }
  }
  return report;
}

std::string summary(const ContactReplayReport& r) {
  const std::string verdict =
      r.is_reproduced() ? "reproduced bit for bit"
                        : fmt::format("differs from tick {} on", r.different_tick);
  return fmt::format(
      "{}: {} of {} ticks are identical\n"
      "largest difference: force {:.3g} N, torque {:.3g} N m\n"
      "net work: {:.6g} J recorded, {:.6g} J now\n",
      verdict, r.identical, r.ticks, r.force_difference_n, r.torque_difference_n_m,
      r.net_energy_j, r.replayed_net_j);
}

std::string to_json(const ContactReplayReport& r) {
  return json_text(nlohmann::json{{"reproduced", r.is_reproduced()},
                                  {"ticks", r.ticks},
                                  {"identical_ticks", r.identical},
                                  {"different_tick", r.different_tick},
                                  {"force_difference_n", r.force_difference_n},
                                  {"torque_difference_n_m", r.torque_difference_n_m},
                                  {"net_energy_j", r.net_energy_j},
                                  {"replayed_net_j", r.replayed_net_j},
                                  {"fault", name(r.fault)}},
                   2);
}

}  // namespace palpate
