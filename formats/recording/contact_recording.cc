#include "formats/recording/contact_recording.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/lines.h"
#include "formats/forms/open_stored.h"

namespace palpate {
namespace {

constexpr const char* kContactFormat = "palpate-contact-recording";
constexpr std::size_t kMostHands = 2;

// What a file holds.
struct ContactRows {
  std::string writer, database, database_sha256, model, fault;
  std::vector<std::string> tools;
  double fast_hz = 0.0, slow_hz = 0.0, force_scale = 1.0, force_max_n = 0.0;
  double ramp_s = 0.0;
  // A row for each tick.
  std::vector<double> time_s;
  RowMajor<double> pose;    // (rows x 7 hands) x y z [m] and the quaternion x y z w
  RowMajor<double> wrench;  // (rows x 6 hands) force [N] and torque [N m]
  std::vector<std::int32_t> contacts;
  std::vector<double> depth_m, work_j, stored_j, tank_j, dissipated_j;

  [[nodiscard]] Eigen::Index hands() const { return std::ssize(tools); }
};

void read_rows(StoredReader& file, ContactRows& r) {
  file.attribute("/", "writer", r.writer);
  file.attribute("/", "database", r.database);
  file.attribute("/", "database_sha256", r.database_sha256);
  file.attribute("/", "fast_hz", r.fast_hz);
  file.attribute("/", "slow_hz", r.slow_hz);
  file.attribute("/", "force_scale", r.force_scale);
  file.attribute("/", "force_max_n", r.force_max_n);
  file.attribute("/", "ramp_s", r.ramp_s);
  file.attribute("/", "fault", r.fault);
  file.group("/tick");
  file.dataset("/tick/time_s", "s", r.time_s);
  file.dataset("/tick/pose", "m 1", r.pose);
  file.dataset("/tick/wrench", "N N.m", r.wrench);
  file.dataset("/tick/contacts", "1", r.contacts);
  file.dataset("/tick/depth_m", "m", r.depth_m);
  file.dataset("/tick/work_j", "J", r.work_j);
  file.dataset("/tick/stored_j", "J", r.stored_j);
  file.dataset("/tick/tank_j", "J", r.tank_j);
  file.dataset("/tick/dissipated_j", "J", r.dissipated_j);
}

void check_head(const StoredReader& file, const ContactRows& r) {
  if (r.tools.empty() || r.tools.size() > kMostHands) {
    file.fail(fmt::format("attribute /@tools names {} tools, must be 1 or 2",
                          r.tools.size()));
  }
  for (const auto& [name, value] :
       {std::pair("fast_hz", r.fast_hz), std::pair("slow_hz", r.slow_hz),
        std::pair("force_scale", r.force_scale),
        std::pair("force_max_n", r.force_max_n), std::pair("ramp_s", r.ramp_s + 1.0)}) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      file.fail(fmt::format("attribute /@{} is out of its range", name));
    }
  }
}

void check_tick_rows(const StoredReader& file, const ContactRows& r) {
  const auto rows = static_cast<Eigen::Index>(r.time_s.size());
  const auto expect = [&](const char* name, Eigen::Index has, Eigen::Index columns,
                          Eigen::Index wanted) {
    if (has != rows || columns != wanted) {
      file.fail(fmt::format("/tick/{} has {} rows of {}, must have {} of {}", name, has,
                            columns, rows, wanted));
    }
  };
  // Of each hand: pose x y z [m] and a unit quaternion, wrench force [N] and torque [N
  // m].
  expect("pose", r.pose.rows(), r.pose.cols(), 7 * r.hands());
  expect("wrench", r.wrench.rows(), r.wrench.cols(), 6 * r.hands());
  expect("contacts", static_cast<Eigen::Index>(r.contacts.size()), 1, 1);
  for (const auto& [name, column] :
       {std::pair("depth_m", &r.depth_m), std::pair("work_j", &r.work_j),
        std::pair("stored_j", &r.stored_j), std::pair("tank_j", &r.tank_j),
        std::pair("dissipated_j", &r.dissipated_j)}) {
    expect(name, static_cast<Eigen::Index>(column->size()), 1, 1);
  }
  constexpr double kUnit = 1e-9;
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (!std::isfinite(r.time_s[at]) || (i > 0 && !(r.time_s[at] > r.time_s[at - 1]))) {
      file.fail(fmt::format("/tick/time_s, row {}: {}, must rise", i, r.time_s[at]));
    }
    for (Eigen::Index hand = 0; hand < r.hands(); ++hand) {
      const auto pose = r.pose.row(i).segment<7>(7 * hand);
      if (!pose.allFinite() || std::abs(pose.tail<4>().norm() - 1.0) > kUnit) {
        file.fail(fmt::format(
            "/tick/pose, row {}: hand {} has no place with a unit quaternion", i,
            hand + 1));
      }
    }
  }
}

// Of a hand in a row.
RecordedHand recorded_hand(const ContactRows& r, Eigen::Index row, Eigen::Index hand) {
  RecordedHand at;
  const double* pose = &r.pose(row, 7 * hand);
  std::copy_n(pose, 3, at.position_m.begin());
  std::copy_n(pose + 3, 4, at.turn.begin());
  const double* wrench = &r.wrench(row, 6 * hand);
  std::copy_n(wrench, 3, at.force_n.begin());
  std::copy_n(wrench + 3, 3, at.torque_n_m.begin());
  return at;
}

TickRecord tick_of(const ContactRows& r, std::size_t i) {
  const auto row = static_cast<Eigen::Index>(i);
  const RecordedHand first = recorded_hand(r, row, 0);
  TickRecord tick;
  tick.tick = row;
  tick.time_ns = std::llround(1e9 * r.time_s[i]);
  tick.position_m = first.position_m;
  tick.turn = first.turn;
  tick.force_n = first.force_n;
  tick.torque_n_m = first.torque_n_m;
  tick.contacts = r.contacts[i];
  tick.depth_m = r.depth_m[i];
  tick.work_j = r.work_j[i];
  tick.stored_j = r.stored_j[i];
  tick.tank_j = r.tank_j[i];
  tick.dissipated_j = r.dissipated_j[i];
  if (r.hands() > 1) {
    tick.second = recorded_hand(r, row, 1);
  }
  return tick;
}

// Those programs did not write the slew, the floor and the recovery of the fast step,
// which were these.
Recording as_recording(const ContactRows& r) {
  Recording recording;
  RecordingHeader& h = recording.header;
  h.writer = r.writer;
  h.database = r.database;
  h.database_sha256 = r.database_sha256;
  h.tool = r.tools.front();
  h.second_tool = r.tools.size() > 1 ? r.tools.back() : "";
  h.model = r.model;
  h.clock = "simulated";
  h.device = "simulated";
  h.fast_hz = r.fast_hz;
  h.slow_hz = r.slow_hz;
  h.force_scale = r.force_scale;
  h.force_max_n = r.force_max_n;
  h.slew_max_n_per_s = 5000.0;
  h.energy_floor_j = 0.01;
  h.recovery_m_per_s = 0.01;
  h.ramp_s = r.ramp_s;
  h.poses = 1.0;
  h.torque_felt = 1.0;
  for (std::size_t i = 0; i < r.time_s.size(); ++i) {
    recording.tick.push_back(tick_of(r, i));
  }
  recording.ended = true;
  recording.end.fault = r.fault;
  recording.old = {
      .time_s = r.time_s,
      // Ticks from one slow update to the next.
      .answer_ticks = std::max<std::int64_t>(1, std::llround(r.fast_hz / r.slow_hz))};
  return recording;
}

}  // namespace

bool is_contact_recording(const std::filesystem::path& file) {
  try {
    const StoredReader in(open_stored(file));
    return in.has_attribute("/", "format") &&
           in.remark("/", "format") == kContactFormat;
  } catch (const Error&) {
    return false;  // who reads it says what is wrong
  }
}

Recording read_contact_recording(const std::filesystem::path& file) {
  StoredReader in(open_stored(file));
  std::string format;
  if (in.has_attribute("/", "format")) {
    in.attribute("/", "format", format);
  }
  if (format != kContactFormat) {
    in.fail("is not a recording of contacts");
  }
  std::int64_t version = 0;
  in.attribute("/", "format_version", version);
  if (version < 1 || version > kContactRecordingVersion) {
    in.fail(fmt::format("format version is {}, must be 1 or {}", version,
                        kContactRecordingVersion));
  }
  ContactRows rows;
  std::string tools;
  in.attribute("/", "tools", tools);
  rows.tools = split_lines(tools);
  // Version 1 knew one local model.
  if (version == 1) {
    rows.model = "facets";
  } else {
    in.attribute("/", "model", rows.model);
  }
  read_rows(in, rows);
  if (in.remark("/", kDigestName) != in.digest()) {
    in.fail("is damaged: its SHA-256 is not the one it states");
  }
  check_head(in, rows);
  check_tick_rows(in, rows);
  return as_recording(rows);
}

}  // namespace palpate
