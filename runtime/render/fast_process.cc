#include "runtime/render/fast_process.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

double seconds(std::int64_t duration_ns) noexcept {
  return static_cast<double>(duration_ns) / kNanosecondsPerSecond;
}

std::array<double, 3> as_array(const Eigen::Vector3d& v) noexcept {
  return {v.x(), v.y(), v.z()};
}

std::uint8_t bit(TickFlag flag, bool set) noexcept {
  return set ? static_cast<std::uint8_t>(flag) : std::uint8_t{0};
}

}  // namespace

FastProcess::FastProcess(const FastProcessConfig& config, Device& device,
                         RenderExchange& exchange, const TickOutputs& outputs)
    : config_(config), device_(device), exchange_(exchange), outputs_(outputs) {
  if (const char* wrong = check(config.fast)) {
    throw InputError(fmt::format("fast step: {}", wrong));
  }
  state_.config = config.fast;
}

bool FastProcess::tick(std::int64_t skipped) noexcept {
  DeviceReading reading = last_;
  reading.withheld_n.setZero();
  const DeviceStatus status = device_.read(reading);
  if (report_.ticks == 0) {
    first_ns_ = reading.time_ns;
    element_ns_ = reading.time_ns;
  }
  watch(reading, status, skipped);
  auto raised = static_cast<std::uint8_t>(state_.safety.fault);
  if (reading.withheld_n != Eigen::Vector3d::Zero()) {
    delivered(state_, held_n_ - reading.withheld_n);
    withheld_ = true;
  }
  const FastCommand command = timed_step(reading);
  if (withheld_ && raised == 0 && state_.safety.fault == Fault::kEnergy) {
    // A recording does not hold what the driver withheld: its replay is told.
    raised = static_cast<std::uint8_t>(Fault::kEnergy);
  }
  if (device_.write(command.force_n) == DeviceStatus::kLost) {
    raise_fault(state_, Fault::kDeviceLost);
  }
  record(reading, command, raised);
  account(reading, command);
  publish(reading);
  return report_.fault == Fault::kNone;
}

void FastProcess::watch(const DeviceReading& reading, DeviceStatus status,
                        std::int64_t skipped) noexcept {
  const bool late = status == DeviceStatus::kLate;
  report_.missed_deadlines += skipped;
  report_.late_reads += late ? 1 : 0;
  // A driver whose clock stands still measures nothing new, whatever it says.
  const bool stands = report_.ticks > 0 && reading.time_ns == last_.time_ns;
  silent_ticks_ = late || stands ? silent_ticks_ + 1 + skipped : 0;
  flags_ = static_cast<std::uint8_t>(bit(TickFlag::kLateRead, late) |
                                     bit(TickFlag::kSkipped, skipped > 0));
  if (status == DeviceStatus::kLost) {
    raise_fault(state_, Fault::kDeviceLost);
  }
  if (static_cast<double>(silent_ticks_) > config_.silent_fault_s * config_.rate_hz) {
    raise_fault(state_, Fault::kDeviceSilent);
  }
  if (report_.ticks > 0 && jumped(reading)) {
    raise_fault(state_, Fault::kJump);
  }
  const double silent_s = seconds(reading.time_ns - element_ns_);
  const bool stalled = silent_s > config_.stall_s;
  report_.slow_stalls += stalled && !stalled_ ? 1 : 0;
  stalled_ = stalled;
  if (silent_s > config_.stall_fault_s && state_.in_contact) {
    raise_fault(state_, Fault::kSlowStalled);
  }
  if (static_cast<double>(skipped) > config_.late_fault_s * config_.rate_hz) {
    raise_fault(state_, Fault::kDeadlines);
  }
}

bool FastProcess::jumped(const DeviceReading& reading) const noexcept {
  constexpr double kStillM = 1e-3;  // noise of readings a few microseconds apart
  const double dt_s = std::max(0.0, seconds(reading.time_ns - last_.time_ns));
  const double most_m = kStillM + config_.speed_max_m_per_s * dt_s;
  return std::isfinite(config_.speed_max_m_per_s) &&
         (reading.position_m - last_.position_m).norm() > most_m;
}

void FastProcess::take_in(const Element& element) noexcept {
  accept(state_, element);
  ++arrivals_;
  const ArrivalRecord arrival{
      .tick = report_.ticks,
      .sequence = static_cast<std::int64_t>(element.sequence),
      .sent_ns = element.sent_ns,
      .triangle = element.triangle,
      .active = element.active ? std::uint8_t{1} : std::uint8_t{0}};
  if (outputs_.telemetry != nullptr) {
    static_cast<void>(outputs_.telemetry->arrivals.push(arrival));  // counts its losses
  }
  if (outputs_.flight != nullptr) {
    outputs_.flight->arrivals.add(arrival);
  }
}

FastCommand FastProcess::timed_step(const DeviceReading& reading) noexcept {
  const double dt_s = report_.ticks == 0 ? 1.0 / config_.rate_hz
                                         : seconds(reading.time_ns - last_.time_ns);
  MonotonicClock wall;
  const std::int64_t begin_ns = wall.now_ns();
  while (const Element* element = exchange_.elements.front()) {
    take_in(*element);
    exchange_.elements.pop();
    element_ns_ = reading.time_ns;
  }
  FastCommand command = step(
      state_, {.position_m = reading.position_m, .time_ns = reading.time_ns}, dt_s);
  report_.step_time.add(wall.now_ns() - begin_ns);
  return command;
}

void FastProcess::account(const DeviceReading& reading,
                          const FastCommand& command) noexcept {
  RenderReport& r = report_;
  // A position that is no number is a fault; the hand felt nothing of it.
  if (r.ticks > 0 && reading.position_m.allFinite()) {
    const double work_j = -held_n_.dot(reading.position_m - last_.position_m);
    (work_j > 0.0 ? r.energy_in_j : r.energy_out_j) += std::abs(work_j);
  }
  held_n_ = command.force_n;
  last_ = reading;
  ++r.ticks;
  r.contact_ticks += command.in_contact ? 1 : 0;
  r.starved_ticks += command.starved ? 1 : 0;
  r.extrapolated_ticks += command.extrapolated ? 1 : 0;
  r.depth_max_m = std::max(r.depth_max_m, command.depth_m);
  r.force_max_n = std::max(r.force_max_n, command.force_n.norm());
  r.model_work_j = state_.ledger.work_j;
  r.stored_j = command.stored_j;
  r.dissipated_j = command.dissipated_j;
  r.tank_j = command.tank_j;
  r.tank_max_j = std::max(r.tank_max_j, command.tank_j);
  r.relaxed_shift_max_m = std::max(r.relaxed_shift_max_m, command.relaxed_shift_m);
  if (remembers(state_.memory)) {
    account_memory(command);
  }
  r.duration_s = seconds(reading.time_ns - first_ns_);
  r.elements_dropped = exchange_.elements.dropped();
  r.fault = state_.safety.fault;
  r.fault_s = r.fault == Fault::kNone ? 0.0 : r.duration_s;
  std::vector<RenderTick>* trace = outputs_.trace;
  if (trace != nullptr && trace->size() < trace->capacity()) {
    trace->push_back({{reading.position_m, reading.time_ns}, command});
  }
}

void FastProcess::account_memory(const FastCommand& command) noexcept {
  RenderReport& r = report_;
  r.relaxes = state_.memory.times.terms > 0;
  r.memory_j = command.memory_j;
  r.memory_max_j = std::max(r.memory_max_j, command.memory_j);
  if (command.carried_n > r.carried_max_n) {
    r.carried_max_n = command.carried_n;
    r.carried_of_n = command.force_n.norm();
  }
  r.forgotten = state_.memory.forgotten;
  r.yields = state_.memory.yields;
  r.yielded_j = command.yielded_j;
  r.not_yielded = state_.memory.yielded.refused;
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
                        .work_j = state_.ledger.work_j,
                        .stored_j = command.stored_j,
                        .tank_j = command.tank_j,
                        .dissipated_j = command.dissipated_j,
                        .relaxed_shift_m = command.relaxed_shift_m,
                        .triangle = contact(state_).triangle,
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

void FastProcess::publish(const DeviceReading& reading) noexcept {
  if (!reading.position_m.allFinite()) {
    return;
  }
  const FastContact at = contact(state_);
  exchange_.tool.write({.sequence = static_cast<std::uint64_t>(report_.ticks),
                        .time_ns = reading.time_ns,
                        .position_m = reading.position_m,
                        .triangle = at.triangle,
                        .in_contact = at.in_contact});
}

}  // namespace palpate
