#include "runtime/run/replay.h"

#include <bit>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"
#include "runtime/render/surface_dents.h"
#include "runtime/slow/memory_elements.h"

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

std::uint8_t flags_of(const FastCommand& command) {
  const auto bit = [](TickFlag flag, bool set) {
    return set ? static_cast<unsigned>(flag) : 0U;
  };
  return static_cast<std::uint8_t>(bit(TickFlag::kContact, command.in_contact) |
                                   bit(TickFlag::kStarved, command.starved) |
                                   bit(TickFlag::kExtrapolated, command.extrapolated));
}

// What differs between a tick and its replay; "" if nothing does.
std::string difference(const TickRecord& tick, const FastCommand& command,
                       const FastState& state) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double force_n = command.force_n[static_cast<Eigen::Index>(axis)];
    if (!same(tick.force_n[axis], force_n)) {
      return fmt::format("force {}: {:.17g} N recorded, {:.17g} N now", "xyz"[axis],
                         tick.force_n[axis], force_n);
    }
  }
  struct Value {
    const char* name;
    double recorded;
    double now;
  };
  for (const Value& v :
       {Value{"work", tick.work_j, state.ledger.work_j},
        Value{"stored energy", tick.stored_j, command.stored_j},
        Value{"tank", tick.tank_j, command.tank_j},
        Value{"dissipated", tick.dissipated_j, command.dissipated_j},
        Value{"depth", tick.depth_m, command.depth_m},
        Value{"relaxed shift", tick.relaxed_shift_m, command.relaxed_shift_m}}) {
    if (!same(v.recorded, v.now)) {
      return fmt::format("{}: {:.17g} recorded, {:.17g} now", v.name, v.recorded,
                         v.now);
    }
  }
  if (tick.triangle != contact(state).triangle) {
    return fmt::format("triangle: {} recorded, {} now", tick.triangle,
                       contact(state).triangle);
  }
  if ((tick.flags & kCompared) != flags_of(command) || tick.fault != command.fault) {
    return "contact or fault";
  }
  return "";
}

// One pass over a recording.
class Pass {
 public:
  Pass(const Recording& recording, const ResponseDatabase& database, LocalModel model)
      : recording_(recording),
        table_(find_tool(database, recording.header.tool)),
        triangles_(static_cast<std::int32_t>(database.body.triangle.rows())),
        stream_(database, table_, recording.header.force_scale) {
    state_->config = fast_config(recording.header);
    state_->config.model = model;
    begin_yielded(recording.header.surface, *state_);
    report_.model = model;
    report_.ticks = static_cast<std::int64_t>(recording.tick.size());
    report_.from_start = recording.tick.empty() || recording.tick.front().tick == 0;
  }

  // @param anew the slow process answers again; else its recorded elements are used.
  ReplayReport run(bool anew) {
    for (const TickRecord& tick : recording_.tick) {
      if (!follows(tick)) {
        break;
      }
      if (anew) {
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
    report_.fault = state_->safety.fault;
    return report_;
  }

 private:
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
      const ArrivalRecord& arrival = recording_.arrival[next_];
      if (arrival.triangle < 0 || arrival.triangle >= triangles_) {
        throw FormatError(
            fmt::format("recording: triangle {} arrived before tick {}, the database "
                        "has {}",
                        arrival.triangle, arrival.tick, triangles_));
      }
      Element element = stream_.element(arrival.triangle);
      element.sequence = static_cast<std::uint64_t>(arrival.sequence);
      element.sent_ns = arrival.sent_ns;
      element.active = arrival.active != 0;
      accept(*state_, element);
    }
    return !report_.from_start || tick.arrivals == static_cast<std::int64_t>(next_);
  }

  void answer(const TickRecord& tick) {
    bool arrived = false;
    for (; next_ < recording_.arrival.size() &&
           recording_.arrival[next_].tick <= tick.tick;
         ++next_) {
      arrived = true;
    }
    if (!arrived || report_.compared == 0) {
      return;
    }
    const FastContact at = contact(*state_);
    (void)stream_.update({.time_ns = before_.time_ns,
                          .position_m = as_vector(before_.position_m),
                          .triangle = at.triangle,
                          .in_contact = at.in_contact},
                         tick.time_ns, *fifo_);
    for (; const Element* element = fifo_->front(); fifo_->pop()) {
      accept(*state_, *element);
    }
  }

  void render(const TickRecord& tick) {
    if (tick.raised != 0) {
      raise_fault(*state_, static_cast<Fault>(tick.raised));
    }
    const double dt_s = report_.compared == 0
                            ? 1.0 / recording_.header.fast_hz
                            : static_cast<double>(tick.time_ns - before_.time_ns) /
                                  kNanosecondsPerSecond;
    const FastCommand command =
        step(*state_,
             {.position_m = as_vector(tick.position_m), .time_ns = tick.time_ns}, dt_s);
    compare(tick, command);
    before_ = tick;
    force_n_ = command.force_n;
    ++report_.compared;
  }

  void compare(const TickRecord& tick, const FastCommand& command) {
    ReplayReport& r = report_;
    const double since_s =
        static_cast<double>(tick.time_ns - recording_.tick.front().time_ns) /
        kNanosecondsPerSecond;
    if (r.different_tick < 0) {
      r.different_in = difference(tick, command, *state_);
      if (r.different_in.empty()) {
        ++r.identical;
      } else {
        r.different_tick = tick.tick;
        r.different_s = since_s;
      }
    }
    const Eigen::Vector3d recorded = as_vector(tick.force_n);
    const double apart = (command.force_n - recorded).norm();
    squares_ += apart * apart;
    if (apart > r.force_difference_n) {
      r.force_difference_n = apart;
      r.force_difference_s = since_s;
    }
    r.force_max_n = std::max(r.force_max_n, recorded.norm());
    r.replayed_max_n = std::max(r.replayed_max_n, command.force_n.norm());
    const Eigen::Vector3d moved =
        as_vector(tick.position_m) - as_vector(before_.position_m);
    if (r.compared > 0 && moved.allFinite()) {
      r.net_energy_j -= as_vector(before_.force_n).dot(moved);
      r.replayed_net_j -= force_n_.dot(moved);
    }
    r.dissipated_j = tick.dissipated_j;
    r.replayed_dissipated_j = command.dissipated_j;
  }

  const Recording& recording_;
  const ResponseTable& table_;
  std::int32_t triangles_;
  ElementStream stream_;
  std::unique_ptr<FastState> state_ = std::make_unique<FastState>();
  std::unique_ptr<ElementFifo> fifo_ = std::make_unique<ElementFifo>();
  std::size_t next_ = 0;  // arrival
  TickRecord before_;
  Eigen::Vector3d force_n_ = Eigen::Vector3d::Zero();
  double squares_ = 0.0;
  ReplayReport report_;
};

LocalModel model_of(const RecordingHeader& header) {
  const auto model = local_model(header.model);
  if (!model) {
    throw FormatError(
        fmt::format("recording: model {:?} is not a local model", header.model));
  }
  return *model;
}

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

RecordingHeader recording_header(const SimulationReport& report,
                                 const FastProcessConfig& config,
                                 const DeviceLimits& limits,
                                 const RecordingRequest& request) {
  return {.writer = "palpate-run " PALPATE_VERSION,
          .database = request.database,
          .database_sha256 = request.database_sha256,
          .tool = report.tool,
          .model = std::string(name(config.fast.model)),
          .clock = report.options.real_time ? "real" : "simulated",
          .device = report.device,
          .fast_hz = config.rate_hz,
          .slow_hz = report.options.slow_hz,
          .force_scale = report.force_scale,
          .tool_radius_m = config.fast.tool_radius_m,
          .force_max_n = config.fast.force_max_n,
          .slew_max_n_per_s = config.fast.slew_max_n_per_s,
          .energy_floor_j = config.fast.energy_floor_j,
          .recovery_m_per_s = config.fast.recovery_m_per_s,
          .ramp_s = config.fast.ramp_s,
          .device_damping_n_s_per_m = limits.damping_n_s_per_m,
          .device_coulomb_n = limits.coulomb_n,
          .device_resolution_m = limits.resolution_m,
          .device_delay_s = limits.delay_s,
          .surface = surface_of(report.options.surface, report.tool)};
}

FastConfig fast_config(const RecordingHeader& header) {
  const FastConfig config{.model = model_of(header),
                          .tool_radius_m = header.tool_radius_m,
                          .force_max_n = header.force_max_n,
                          .slew_max_n_per_s = header.slew_max_n_per_s,
                          .energy_floor_j = header.energy_floor_j,
                          .recovery_m_per_s = header.recovery_m_per_s,
                          .ramp_s = header.ramp_s};
  if (const char* wrong = check(config)) {
    throw FormatError(fmt::format("recording: {}", wrong));
  }
  return config;
}

ReplayReport replay(const Recording& recording, const ResponseDatabase& database) {
  return Pass(recording, database, model_of(recording.header)).run(false);
}

ReplayReport render_again(const Recording& recording, const ResponseDatabase& database,
                          LocalModel model) {
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
             "{:<20}rms {:.4g} N, largest {:.4g} N at {:.4g} s\n"
             "{:<20}{:.4g} N recorded, {:.4g} N now\n"
             "{:<20}{:.4g} mJ recorded, {:.4g} mJ now\n"
             "{:<20}{:.4g} mJ recorded, {:.4g} mJ now\n"
             "{:<20}{}\n",
             "model", name(r.model), r.compared, "force difference", r.force_rms_n,
             r.force_difference_n, r.force_difference_s, "largest force", r.force_max_n,
             r.replayed_max_n, "net energy of hand", r.net_energy_j * 1e3,
             r.replayed_net_j * 1e3, "dissipated", r.dissipated_j * 1e3,
             r.replayed_dissipated_j * 1e3, "fault", name(r.fault));
}

}  // namespace palpate
