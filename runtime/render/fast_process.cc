#include "runtime/render/fast_process.h"

#include <algorithm>
#include <cmath>

#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

std::array<double, 3> as_array(const Eigen::Vector3d& v) noexcept {
  return {v.x(), v.y(), v.z()};
}

RecordedHand recorded(const DeviceReading& reading, const Wrench& wrench) noexcept {
  const Eigen::Vector4d turn = reading.turn.coeffs();  // x y z w
  return {.position_m = as_array(reading.position_m),
          .turn = {turn.x(), turn.y(), turn.z(), turn.w()},
          .force_n = as_array(wrench.force_n),
          .torque_n_m = as_array(wrench.torque_n_m)};
}

std::uint8_t bit(TickFlag flag, bool set) noexcept {
  return set ? static_cast<std::uint8_t>(flag) : std::uint8_t{0};
}

}  // namespace

bool FastProcess::tick(std::int64_t skipped) noexcept {
  HandReadings reading = last_;
  read(reading, skipped);
  auto raised = static_cast<std::uint8_t>(body_.fault());
  tell_withheld(reading);
  const WrenchCommand command = timed_step(reading);
  if (withheld_ && raised == 0 && body_.fault() == Fault::kEnergy) {
    // A recording does not hold what the driver withheld: its replay needs them.
    raised = static_cast<std::uint8_t>(Fault::kEnergy);
  }
  bool placed = true;
  for (std::size_t hand = 0; hand < hands_; ++hand) {
    if (hand_[hand].device->write(command.wrench[hand].force_n) ==
        DeviceStatus::kLost) {
      body_.raise(Fault::kDeviceLost);
    }
    placed = placed && reading[hand].position_m.allFinite();
  }
  record(reading, command, raised);
  account(reading, command);
  if (placed) {
    body_.publish(reading, report_.ticks);
  }
  return report_.fault == Fault::kNone;
}

// Reads all devices, and looks at what they are.
void FastProcess::read(HandReadings& reading, std::int64_t skipped) noexcept {
  std::array<DeviceStatus, kPortsMax> status{};
  for (std::size_t hand = 0; hand < hands_; ++hand) {
    reading[hand].withheld_n.setZero();
    status[hand] = hand_[hand].device->read(reading[hand]);
  }
  if (report_.ticks == 0) {
    first_ns_ = reading[0].time_ns;
    element_ns_ = reading[0].time_ns;
  }
  report_.missed_deadlines += skipped;
  flags_ = bit(TickFlag::kSkipped, skipped > 0);
  for (std::size_t hand = 0; hand < hands_; ++hand) {
    watch_hand(hand, reading[hand], status[hand], skipped);
  }
  watch(reading[0].time_ns, skipped);
}

void FastProcess::watch_hand(std::size_t hand, const DeviceReading& reading,
                             DeviceStatus status, std::int64_t skipped) noexcept {
  Hand& held = hand_[hand];
  const bool late = status == DeviceStatus::kLate;
  report_.late_reads += late ? 1 : 0;
  // A driver whose clock stands still measures nothing new, whatever it says.
  const bool stands = report_.ticks > 0 && reading.time_ns == last_[hand].time_ns;
  // After ticks that this process itself missed, a device has until the next one.
  const std::int64_t silent = held.silent_ticks > 0 ? 1 + skipped : 1;
  held.silent_ticks = late || stands ? held.silent_ticks + silent : 0;
  flags_ = static_cast<std::uint8_t>(flags_ | bit(TickFlag::kLateRead, late));
  if (status == DeviceStatus::kLost) {
    body_.raise(Fault::kDeviceLost);
  }
  if (static_cast<double>(held.silent_ticks) >
      config_.silent_fault_s * config_.rate_hz) {
    body_.raise(Fault::kDeviceSilent);
  }
  if (report_.ticks > 0 && jumped(last_[hand], reading)) {
    body_.raise(Fault::kJump);
  }
  if (const Fault fault = held.wire.fault(body_.in_contact()); fault != Fault::kNone) {
    body_.raise(fault);
  }
}

void FastProcess::watch(std::int64_t now_ns, std::int64_t skipped) noexcept {
  const double silent_s = seconds_in(now_ns - element_ns_);
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

void FastProcess::tell_withheld(const HandReadings& reading) noexcept {
  PortWrenches made;
  bool some = false;
  for (std::size_t hand = 0; hand < hands_; ++hand) {
    made[hand] = hand_[hand].held;
    made[hand].force_n -= reading[hand].withheld_n;
    some = some || reading[hand].withheld_n != Eigen::Vector3d::Zero();
  }
  if (some) {
    body_.delivered(made);
    withheld_ = true;
  }
}

bool FastProcess::jumped(const DeviceReading& from,
                         const DeviceReading& to) const noexcept {
  constexpr double kStillM = 1e-3;  // noise of readings a few microseconds apart
  const double dt_s = std::max(0.0, seconds_in(to.time_ns - from.time_ns));
  const double most_m = kStillM + config_.speed_max_m_per_s * dt_s;
  return std::isfinite(config_.speed_max_m_per_s) &&
         (to.position_m - from.position_m).norm() > most_m;
}

void FastProcess::take_in_arrivals(std::int64_t now_ns) noexcept {
  ArrivalRecord arrival{.tick = report_.ticks};
  for (int taken = 0; taken < kElementsATick && body_.take_in(arrival); ++taken) {
    ++arrivals_;
    element_ns_ = now_ns;
    if (outputs_.telemetry != nullptr) {
      static_cast<void>(outputs_.telemetry->arrivals.push(arrival));  // counts losses
    }
    if (outputs_.flight != nullptr) {
      outputs_.flight->arrivals.add(arrival);
    }
  }
}

WrenchCommand FastProcess::timed_step(const HandReadings& reading) noexcept {
  const std::int64_t now_ns = reading[0].time_ns;
  const double dt_s = report_.ticks == 0 ? 1.0 / config_.rate_hz
                                         : seconds_in(now_ns - last_[0].time_ns);
  MonotonicClock wall;
  const std::int64_t begin_ns = wall.now_ns();
  take_in_arrivals(now_ns);
  const WrenchCommand command = body_.step(reading, dt_s);
  report_.step_time.add(wall.now_ns() - begin_ns);
  return command;
}

// A position that is no number is a fault; the hand felt nothing of it. Each wire is
// lent what the model could give back, as if it were the only one.
void FastProcess::account_hand(std::size_t hand, const DeviceReading& reading,
                               const WrenchCommand& command) noexcept {
  Hand& held = hand_[hand];
  const DeviceReading& last = last_[hand];
  const std::int64_t now_ns = reading.read_ns == 0 ? reading.time_ns : reading.read_ns;
  if (report_.ticks > 0 && reading.position_m.allFinite()) {
    const Eigen::Vector3d moved_m = reading.position_m - last.position_m;
    double work_j = -held.held.force_n.dot(moved_m);
    if (body_.torque_felt()) {
      const Eigen::AngleAxisd turned(reading.turn * last.turn.conjugate());
      work_j -= turned.angle() * held.held.torque_n_m.dot(turned.axis());
    }
    (work_j > 0.0 ? report_.energy_in_j : report_.energy_out_j) += std::abs(work_j);
    held.wire.move({.from_ns = last.time_ns,
                    .to_ns = reading.time_ns,
                    .read_ns = now_ns,
                    .moved_m = moved_m,
                    .withheld_n = reading.withheld_n},
                   body_.work_j() - command.dissipated_j);
    report_.held_s = std::max(hand == 0 ? 0.0 : report_.held_s, held.wire.held_s());
  }
  held.wire.hold(now_ns, command.wrench[hand].force_n);
  held.held = command.wrench[hand];
}

void FastProcess::account(const HandReadings& reading,
                          const WrenchCommand& command) noexcept {
  RenderReport& r = report_;
  for (std::size_t hand = 0; hand < hands_; ++hand) {
    account_hand(hand, reading[hand], command);
    r.force_max_n = std::max(r.force_max_n, command.wrench[hand].force_n.norm());
    r.torque_max_n_m =
        std::max(r.torque_max_n_m, command.wrench[hand].torque_n_m.norm());
  }
  last_ = reading;
  ++r.ticks;
  r.contact_ticks += command.in_contact ? 1 : 0;
  r.starved_ticks += command.starved ? 1 : 0;
  r.extrapolated_ticks += command.extrapolated ? 1 : 0;
  r.scaled_ticks += command.scaled ? 1 : 0;
  r.contacts_max = std::max(r.contacts_max, command.contacts);
  r.depth_max_m = std::max(r.depth_max_m, command.depth_m);
  r.model_work_j = body_.work_j();
  r.lowest_work_j = std::min(r.lowest_work_j, r.model_work_j);
  r.stored_j = command.stored_j;
  r.dissipated_j = command.dissipated_j;
  r.tank_j = command.tank_j;
  r.tank_max_j = std::max(r.tank_max_j, command.tank_j);
  r.rest_offset_max_m = std::max(r.rest_offset_max_m, command.rest_offset_m);
  body_.account(command, r);
  r.duration_s = seconds_in(reading[0].time_ns - first_ns_);
  r.elements_dropped = body_.dropped();
  r.fault = body_.fault();
  r.fault_s = r.fault == Fault::kNone ? 0.0 : r.duration_s;
  trace(reading, command);
}

void FastProcess::trace(const HandReadings& reading,
                        const WrenchCommand& command) noexcept {
  std::vector<RenderTick>* ticks = outputs_.trace;
  if (ticks == nullptr || ticks->size() >= ticks->capacity()) {
    return;
  }
  RenderTick tick{.time_ns = reading[0].time_ns,
                  .pose = {},
                  .command = command,
                  .work_j = body_.work_j()};
  for (std::size_t hand = 0; hand < hands_; ++hand) {
    tick.pose[hand] = {reading[hand].position_m, reading[hand].turn};
  }
  ticks->push_back(tick);
}

void FastProcess::record(const HandReadings& reading, const WrenchCommand& command,
                         std::uint8_t raised) noexcept {
  if (outputs_.telemetry == nullptr && outputs_.flight == nullptr &&
      outputs_.watch == nullptr) {
    return;
  }
  const auto flags =
      static_cast<std::uint8_t>(flags_ | bit(TickFlag::kContact, command.in_contact) |
                                bit(TickFlag::kStarved, command.starved) |
                                bit(TickFlag::kExtrapolated, command.extrapolated));
  const RecordedHand first = recorded(reading[0], command.wrench[0]);
  const TickRecord tick{
      .tick = report_.ticks,
      .time_ns = reading[0].time_ns,
      .arrivals = arrivals_,
      .position_m = first.position_m,
      .force_n = first.force_n,
      .depth_m = command.depth_m,
      .work_j = body_.work_j(),
      .stored_j = command.stored_j,
      .tank_j = command.tank_j,
      .dissipated_j = command.dissipated_j,
      .rest_offset_m = command.rest_offset_m,
      .triangle = body_.triangle(),
      .flags = flags,
      .raised = raised,
      .fault = command.fault,
      .turn = first.turn,
      .torque_n_m = first.torque_n_m,
      .contacts = command.contacts,
      .second = hands_ > 1 ? recorded(reading[1], command.wrench[1]) : RecordedHand{}};
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
