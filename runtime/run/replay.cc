#include "runtime/run/replay.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"
#include "runtime/run/recorded_setup.h"

namespace palpate {
namespace {

constexpr auto kCompared =
    static_cast<std::uint8_t>(static_cast<unsigned>(TickFlag::kContact) |
                              static_cast<unsigned>(TickFlag::kStarved) |
                              static_cast<unsigned>(TickFlag::kExtrapolated));

Eigen::Vector3d as_vector(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

std::uint8_t flags_of(const TickAccount& command) {
  const auto bit = [](TickFlag flag, bool set) {
    return set ? static_cast<unsigned>(flag) : 0U;
  };
  return static_cast<std::uint8_t>(bit(TickFlag::kContact, command.in_contact) |
                                   bit(TickFlag::kStarved, command.starved) |
                                   bit(TickFlag::kExtrapolated, command.extrapolated));
}

// What differs along an axis; "" if nothing does.
std::string difference(const char* what, const char* unit,
                       const std::array<double, 3>& recorded,
                       const Eigen::Vector3d& now) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double value = now[static_cast<Eigen::Index>(axis)];
    if (!same(recorded[axis], value)) {
      return fmt::format("{} {}: {:.17g} {} recorded, {:.17g} {} now", what,
                         "xyz"[axis], recorded[axis], unit, value, unit);
    }
  }
  return "";
}

std::string difference(const RecordedHand& hand, const Wrench& wrench) {
  const std::string force = difference("force", "N", hand.force_n, wrench.force_n);
  return force.empty() ? difference("torque", "N m", hand.torque_n_m, wrench.torque_n_m)
                       : force;
}

// What differs between a tick and its replay; "" if nothing does.
std::string difference(const Recording& recording, const TickRecord& tick,
                       const WrenchCommand& command, const RenderedBody& body) {
  std::string wrench = difference(hand_in(tick, 0), command.wrench[0]);
  if (wrench.empty() && recording.hands() > 1) {
    wrench = difference(tick.second, command.wrench[1]);
    wrench += wrench.empty() ? "" : ", of the second hand";
  }
  if (!wrench.empty()) {
    return wrench;
  }
  struct Value {
    const char* name;
    double recorded;
    double now;
  };
  for (const Value& v : {Value{"work", tick.work_j, body.work_j()},
                         Value{"stored energy", tick.stored_j, command.stored_j},
                         Value{"tank", tick.tank_j, command.tank_j},
                         Value{"dissipated", tick.dissipated_j, command.dissipated_j},
                         Value{"depth", tick.depth_m, command.depth_m}}) {
    if (!same(v.recorded, v.now)) {
      return fmt::format("{}: {:.17g} recorded, {:.17g} now", v.name, v.recorded,
                         v.now);
    }
  }
  if (recording.header.poses != 0.0 && tick.contacts != command.contacts) {
    return fmt::format("contacts: {} recorded, {} now", tick.contacts,
                       command.contacts);
  }
  if (recording.old) {
    return "";  // has nothing more
  }
  if (!same(tick.rest_offset_m, command.rest_offset_m)) {
    return fmt::format("rest offset: {:.17g} recorded, {:.17g} now", tick.rest_offset_m,
                       command.rest_offset_m);
  }
  if (tick.triangle != body.triangle()) {
    return fmt::format("triangle: {} recorded, {} now", tick.triangle, body.triangle());
  }
  if ((tick.flags & kCompared) != flags_of(command) || tick.fault != command.fault) {
    return "contact or fault";
  }
  return "";
}

DeviceReading reading_of(const RecordedHand& hand, std::int64_t time_ns) {
  DeviceReading reading;
  reading.position_m = as_vector(hand.position_m);
  reading.time_ns = time_ns;
  reading.turn =
      Eigen::Quaterniond(hand.turn[3], hand.turn[0], hand.turn[1], hand.turn[2]);
  return reading;
}

HandReadings readings_of(const TickRecord& tick) {
  return {reading_of(hand_in(tick, 0), tick.time_ns),
          reading_of(tick.second, tick.time_ns)};
}

// One pass over a recording.
class Pass {
 public:
  Pass(const Recording& recording, const ResponseDatabase& database, LocalModel model)
      : recording_(recording), replayed_(recording.header, database, model) {
    report_.model = model;
    report_.ticks = static_cast<std::int64_t>(recording.tick.size());
    report_.from_start = recording.tick.empty() || recording.tick.front().tick == 0;
  }

  // @param anew the slow process answers again; else its recorded elements are used,
  // where there are any.
  ReplayReport run(bool anew) {
    for (const TickRecord& tick : recording_.tick) {
      if (!follows(tick)) {
        break;
      }
      if (anew || recording_.old) {
        answer(tick);
      } else if (!take_in(tick)) {
        report_.gap_tick = tick.tick;
        break;
      }
      render(tick);
    }
    const auto compared =
        static_cast<double>(std::max<std::int64_t>(1, report_.compared));
    report_.force_rms_n = std::sqrt(squares_ / compared);
    report_.fault = body().fault();
    return report_;
  }

 private:
  [[nodiscard]] RenderedBody& body() noexcept { return replayed_.body(); }

  // Whether the tick is the one after the last.
  bool follows(const TickRecord& tick) {
    if (report_.compared > 0 && tick.tick != before_.tick + 1) {
      report_.gap_tick = before_.tick + 1;
      return false;
    }
    return true;
  }

  // False if elements are missing that the run had.
  bool take_in(const TickRecord& tick) {
    for (; next_ < recording_.arrival.size() &&
           recording_.arrival[next_].tick <= tick.tick;
         ++next_) {
      body().accept(recording_.arrival[next_]);
    }
    return !report_.from_start || tick.arrivals == static_cast<std::int64_t>(next_);
  }

  // Whether the slow process had answered before the tick.
  bool answered_before(const TickRecord& tick) {
    if (recording_.old) {
      return tick.tick % recording_.old->answer_ticks == 0;
    }
    bool arrived = false;
    for (; next_ < recording_.arrival.size() &&
           recording_.arrival[next_].tick <= tick.tick;
         ++next_) {
      arrived = true;
    }
    return arrived && report_.compared > 0;
  }

  void answer(const TickRecord& tick) {
    if (!answered_before(tick)) {
      return;
    }
    body().publish(readings_of(report_.compared > 0 ? before_ : tick),
                   report_.compared);
    static_cast<void>(body().serve(tick.time_ns));
    ArrivalRecord arrival;
    while (body().take_in(arrival)) {
    }
  }

  [[nodiscard]] double dt_s(const TickRecord& tick) const {
    if (report_.compared == 0) {
      return 1.0 / recording_.header.fast_hz;
    }
    if (recording_.old) {
      const auto row = static_cast<std::size_t>(tick.tick);
      return recording_.old->time_s[row] - recording_.old->time_s[row - 1];
    }
    return seconds_in(tick.time_ns - before_.time_ns);
  }

  void render(const TickRecord& tick) {
    if (tick.raised != 0) {
      body().raise(static_cast<Fault>(tick.raised));
    }
    const WrenchCommand command = body().step(readings_of(tick), dt_s(tick));
    compare(tick, command);
    before_ = tick;
    wrench_ = command.wrench;
    ++report_.compared;
  }

  void compare(const TickRecord& tick, const WrenchCommand& command) {
    ReplayReport& r = report_;
    const double since_s = seconds_in(tick.time_ns - recording_.tick.front().time_ns);
    if (r.different_tick < 0) {
      r.different_in = difference(recording_, tick, command, body());
      if (r.different_in.empty()) {
        ++r.identical;
      } else {
        r.different_tick = tick.tick;
        r.different_s = since_s;
      }
    }
    compare(hand_in(tick, 0), hand_in(before_, 0), command.wrench[0], wrench_[0],
            since_s);
    if (recording_.hands() > 1) {
      compare(tick.second, before_.second, command.wrench[1], wrench_[1], since_s);
    }
    r.dissipated_j = tick.dissipated_j;
    r.replayed_dissipated_j = command.dissipated_j;
  }

  // A hand now and before, and what is rendered for it.
  void compare(const RecordedHand& hand, const RecordedHand& before, const Wrench& now,
               const Wrench& then, double since_s) {
    ReplayReport& r = report_;
    const Eigen::Vector3d recorded = as_vector(hand.force_n);
    const double apart = (now.force_n - recorded).norm();
    squares_ += apart * apart;
    if (apart > r.force_difference_n) {
      r.force_difference_n = apart;
      r.force_difference_s = since_s;
    }
    r.torque_difference_n_m = std::max(
        r.torque_difference_n_m, (now.torque_n_m - as_vector(hand.torque_n_m)).norm());
    r.force_max_n = std::max(r.force_max_n, recorded.norm());
    r.replayed_max_n = std::max(r.replayed_max_n, now.force_n.norm());
    const Eigen::Vector3d moved =
        as_vector(hand.position_m) - as_vector(before.position_m);
    if (r.compared > 0 && moved.allFinite()) {
      r.net_energy_j -= as_vector(before.force_n).dot(moved);
      r.replayed_net_j -= then.force_n.dot(moved);
    }
  }

  const Recording& recording_;
  ReplayedBody replayed_;
  std::size_t next_ = 0;  // arrival
  TickRecord before_;
  PortWrenches wrench_;
  double squares_ = 0.0;
  ReplayReport report_;
};

std::string verdict(const ReplayReport& r) {
  if (r.is_reproduced()) {
    return fmt::format("reproduced: {} ticks bit for bit\n", r.ticks);
  }
  if (!r.from_start) {
    return "not reproduced: the recording does not begin with the run\n";
  }
  if (r.different_tick >= 0) {
    return fmt::format("differs from tick {} ({:.6g} s) on, {}\n", r.different_tick,
                       r.different_s, r.different_in);
  }
  return fmt::format(
      "the same bits for {} of {} ticks, up to tick {}, which the recording lacks\n",
      r.identical, r.ticks, r.gap_tick);
}

}  // namespace

ReplayReport replay(const Recording& recording, const ResponseDatabase& database) {
  return Pass(recording, database, fast_config(recording.header).model).run(false);
}

ReplayReport render_again(const Recording& recording, const ResponseDatabase& database,
                          LocalModel model) {
  if (recording.header.poses != 0.0 && !is_field(model)) {
    throw InputError(
        fmt::format("several contacts are rendered by potential or facets, not by {}",
                    name(model)));
  }
  return Pass(recording, database, model).run(true);
}

void check_same_database(const Recording& recording, const std::string& sha256,
                         const std::string& database) {
  if (recording.header.database_sha256 != sha256) {
    throw InputError(fmt::format(
        "{}: is not the database of the recording, {} ({:.12}..., this one {:.12}...); "
        "--other-database renders it all the same",
        database, recording.header.database, recording.header.database_sha256, sha256));
  }
}

std::string summary(const ReplayReport& r, bool exact) {
  return (exact ? verdict(r) : std::string()) +
         fmt::format(
             "{:<20}{}, {} ticks\n"
             "{:<20}rms {:.4g} N, largest {:.4g} N at {:.4g} s{}\n"
             "{:<20}{:.4g} N recorded, {:.4g} N now\n"
             "{:<20}{:.4g} mJ recorded, {:.4g} mJ now\n"
             "{:<20}{:.4g} mJ recorded, {:.4g} mJ now\n"
             "{:<20}{}\n",
             "model", name(r.model), r.compared, "force difference", r.force_rms_n,
             r.force_difference_n, r.force_difference_s,
             r.torque_difference_n_m > 0.0
                 ? fmt::format(", torque {:.4g} N m", r.torque_difference_n_m)
                 : std::string(),
             "largest force", r.force_max_n, r.replayed_max_n, "net energy of hand",
             r.net_energy_j * 1e3, r.replayed_net_j * 1e3, "dissipated",
             r.dissipated_j * 1e3, r.replayed_dissipated_j * 1e3, "fault",
             name(r.fault));
}

}  // namespace palpate
