#include "runtime/render/fast_process.h"

#include <algorithm>
#include <cmath>

#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

std::array<double, 3> as_array(const Eigen::Vector3d& v) noexcept {
  return {v.x(), v.y(), v.z()};
}

std::uint8_t bit(TickFlag flag, bool set) noexcept {
  return set ? static_cast<std::uint8_t>(flag) : std::uint8_t{0};
}

}  // namespace

bool FastProcess::tick(std::int64_t skipped) noexcept {
  DeviceReading reading = last_;
  reading.withheld_n.setZero();
  const DeviceStatus status = device_.read(reading);
  if (report_.ticks == 0) {
    first_ns_ = reading.time_ns;
    element_ns_ = reading.time_ns;
  }
  watch(reading, status, skipped);
  auto raised = static_cast<std::uint8_t>(body_.fault());
  if (reading.withheld_n != Eigen::Vector3d::Zero()) {
    body_.delivered(held_n_ - reading.withheld_n);
    withheld_ = true;
  }
  const FastCommand command = timed_step(reading);
  if (withheld_ && raised == 0 && body_.fault() == Fault::kEnergy) {
    // A recording does not hold what the driver withheld: its replay is told.
    raised = static_cast<std::uint8_t>(Fault::kEnergy);
  }
  if (device_.write(command.force_n) == DeviceStatus::kLost) {
    body_.raise(Fault::kDeviceLost);
  }
  record(reading, command, raised);
  account(reading, command);
  if (reading.position_m.allFinite()) {
    body_.publish(reading, report_.ticks);
  }
  return report_.fault == Fault::kNone;
}

void FastProcess::watch(const DeviceReading& reading, DeviceStatus status,
                        std::int64_t skipped) noexcept {
  const bool late = status == DeviceStatus::kLate;
  report_.missed_deadlines += skipped;
  report_.late_reads += late ? 1 : 0;
  // A driver whose clock stands still measures nothing new, whatever it says.
  const bool stands = report_.ticks > 0 && reading.time_ns == last_.time_ns;
  // After ticks that this process itself missed, a device has until the next one.
  const std::int64_t silent = silent_ticks_ > 0 ? 1 + skipped : 1;
  silent_ticks_ = late || stands ? silent_ticks_ + silent : 0;
  flags_ = static_cast<std::uint8_t>(bit(TickFlag::kLateRead, late) |
                                     bit(TickFlag::kSkipped, skipped > 0));
  if (status == DeviceStatus::kLost) {
    body_.raise(Fault::kDeviceLost);
  }
  if (static_cast<double>(silent_ticks_) > config_.silent_fault_s * config_.rate_hz) {
    body_.raise(Fault::kDeviceSilent);
  }
  if (report_.ticks > 0 && jumped(reading)) {
    body_.raise(Fault::kJump);
  }
  if (const Fault fault = wire_.fault(body_.in_contact()); fault != Fault::kNone) {
    body_.raise(fault);
  }
  const double silent_s = seconds_in(reading.time_ns - element_ns_);
  const bool stalled = silent_s > config_.stall_s;
  report_.slow_stalls += stalled && !stalled_ ? 1 : 0;
  stalled_ = stalled;
  if (silent_s > config_.stall_fault_s && body_.in_contact()) {
    body_.raise(Fault::kSlowStalled);
  }
  if (static_cast<double>(skipped) > config_.late_fault_s * config_.rate_hz) {
    body_.raise(Fault::kDeadlines);
  }
}

bool FastProcess::jumped(const DeviceReading& reading) const noexcept {
  constexpr double kStillM = 1e-3;  // noise of readings a few microseconds apart
  const double dt_s = std::max(0.0, seconds_in(reading.time_ns - last_.time_ns));
  const double most_m = kStillM + config_.speed_max_m_per_s * dt_s;
  return std::isfinite(config_.speed_max_m_per_s) &&
         (reading.position_m - last_.position_m).norm() > most_m;
}

void FastProcess::take_in_arrivals(const DeviceReading& reading) noexcept {
  ArrivalRecord arrival{.tick = report_.ticks};
  for (int taken = 0; taken < kElementsATick && body_.take_in(arrival); ++taken) {
    ++arrivals_;
    element_ns_ = reading.time_ns;
    if (outputs_.telemetry != nullptr) {
      static_cast<void>(outputs_.telemetry->arrivals.push(arrival));  // counts losses
    }
    if (outputs_.flight != nullptr) {
      outputs_.flight->arrivals.add(arrival);
    }
  }
}

FastCommand FastProcess::timed_step(const DeviceReading& reading) noexcept {
  const double dt_s = report_.ticks == 0 ? 1.0 / config_.rate_hz
                                         : seconds_in(reading.time_ns - last_.time_ns);
  MonotonicClock wall;
  const std::int64_t begin_ns = wall.now_ns();
  take_in_arrivals(reading);
  FastCommand command = body_.step(reading, dt_s);
  report_.step_time.add(wall.now_ns() - begin_ns);
  return command;
}

// A position that is no number is a fault; the hand felt nothing of it.
void FastProcess::account_hand(const DeviceReading& reading,
                               const FastCommand& command) noexcept {
  const std::int64_t now_ns = reading.read_ns == 0 ? reading.time_ns : reading.read_ns;
  if (report_.ticks > 0 && reading.position_m.allFinite()) {
    const Eigen::Vector3d moved_m = reading.position_m - last_.position_m;
    const double work_j = -held_n_.dot(moved_m);
    (work_j > 0.0 ? report_.energy_in_j : report_.energy_out_j) += std::abs(work_j);
    wire_.move({.from_ns = last_.time_ns,
                .to_ns = reading.time_ns,
                .read_ns = now_ns,
                .moved_m = moved_m,
                .withheld_n = reading.withheld_n},
               body_.work_j() - command.dissipated_j);
    report_.held_s = wire_.held_s();
  }
  wire_.hold(now_ns, command.force_n);
}

void FastProcess::account(const DeviceReading& reading,
                          const FastCommand& command) noexcept {
  RenderReport& r = report_;
  account_hand(reading, command);
  held_n_ = command.force_n;
  last_ = reading;
  ++r.ticks;
  r.contact_ticks += command.in_contact ? 1 : 0;
  r.starved_ticks += command.starved ? 1 : 0;
  r.extrapolated_ticks += command.extrapolated ? 1 : 0;
  r.depth_max_m = std::max(r.depth_max_m, command.depth_m);
  r.force_max_n = std::max(r.force_max_n, command.force_n.norm());
  r.model_work_j = body_.work_j();
  r.stored_j = command.stored_j;
  r.dissipated_j = command.dissipated_j;
  r.tank_j = command.tank_j;
  r.tank_max_j = std::max(r.tank_max_j, command.tank_j);
  r.relaxed_shift_max_m = std::max(r.relaxed_shift_max_m, command.relaxed_shift_m);
  body_.account(command, r);
  r.duration_s = seconds_in(reading.time_ns - first_ns_);
  r.elements_dropped = body_.dropped();
  r.fault = body_.fault();
  r.fault_s = r.fault == Fault::kNone ? 0.0 : r.duration_s;
  std::vector<RenderTick>* trace = outputs_.trace;
  if (trace != nullptr && trace->size() < trace->capacity()) {
    trace->push_back({{reading.position_m, reading.time_ns}, command});
  }
}

void FastProcess::record(const DeviceReading& reading, const FastCommand& command,
                         std::uint8_t raised) noexcept {
  if (outputs_.telemetry == nullptr && outputs_.flight == nullptr &&
      outputs_.watch == nullptr) {
    return;
  }
  const auto flags =
      static_cast<std::uint8_t>(flags_ | bit(TickFlag::kContact, command.in_contact) |
                                bit(TickFlag::kStarved, command.starved) |
                                bit(TickFlag::kExtrapolated, command.extrapolated));
  const TickRecord tick{.tick = report_.ticks,
                        .time_ns = reading.time_ns,
                        .arrivals = arrivals_,
                        .position_m = as_array(reading.position_m),
                        .force_n = as_array(command.force_n),
                        .depth_m = command.depth_m,
                        .work_j = body_.work_j(),
                        .stored_j = command.stored_j,
                        .tank_j = command.tank_j,
                        .dissipated_j = command.dissipated_j,
                        .relaxed_shift_m = command.relaxed_shift_m,
                        .triangle = body_.triangle(),
                        .flags = flags,
                        .raised = raised,
                        .fault = command.fault};
  if (outputs_.telemetry != nullptr) {
    static_cast<void>(outputs_.telemetry->ticks.push(tick));  // counts its losses
  }
  if (outputs_.flight != nullptr) {
    outputs_.flight->ticks.add(tick);
  }
  if (outputs_.watch != nullptr) {
    static_cast<void>(outputs_.watch->push(tick));  // who looks on may miss some
  }
}

}  // namespace palpate
