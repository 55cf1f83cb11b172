#include "runtime/fast_process.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/error.h"
#include "runtime/clock.h"

namespace palpate {
namespace {

double seconds(std::int64_t duration_ns) noexcept {
  return static_cast<double>(duration_ns) / kNanosecondsPerSecond;
}

}  // namespace

FastProcess::FastProcess(const FastProcessConfig& config, Device& device,
                         RenderExchange& exchange, std::vector<RenderTick>* trace)
    : config_(config), device_(device), exchange_(exchange), trace_(trace) {
  if (const char* wrong = check(config.fast)) {
    throw InputError(fmt::format("fast step: {}", wrong));
  }
  state_.config = config.fast;
}

bool FastProcess::tick(std::int64_t skipped) noexcept {
  DeviceReading reading = last_;
  const DeviceStatus status = device_.read(reading);
  if (report_.ticks == 0) {
    first_ns_ = reading.time_ns;
    element_ns_ = reading.time_ns;
  }
  report_.missed_deadlines += skipped;
  report_.late_reads += status == DeviceStatus::kLate ? 1 : 0;
  if (status == DeviceStatus::kLost) {
    raise_fault(state_, Fault::kDeviceLost);
  }
  watch(reading, skipped);
  const FastCommand command = timed_step(reading);
  if (device_.write(command.force_n) == DeviceStatus::kLost) {
    raise_fault(state_, Fault::kDeviceLost);
  }
  account(reading, command);
  publish(reading);
  return report_.fault == Fault::kNone;
}

void FastProcess::watch(const DeviceReading& reading, std::int64_t skipped) noexcept {
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

FastCommand FastProcess::timed_step(const DeviceReading& reading) noexcept {
  const double dt_s = report_.ticks == 0 ? 1.0 / config_.rate_hz
                                         : seconds(reading.time_ns - last_.time_ns);
  MonotonicClock wall;
  const std::int64_t begin_ns = wall.now_ns();
  while (const Element* element = exchange_.elements.front()) {
    accept(state_, *element);
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
  if (r.ticks > 0) {
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
  r.duration_s = seconds(reading.time_ns - first_ns_);
  r.elements_dropped = exchange_.elements.dropped();
  r.fault = state_.safety.fault;
  r.fault_s = r.fault == Fault::kNone ? 0.0 : r.duration_s;
  if (trace_ != nullptr && trace_->size() < trace_->capacity()) {
    trace_->push_back({{reading.position_m, reading.time_ns}, command});
  }
}

void FastProcess::publish(const DeviceReading& reading) noexcept {
  const FastContact at = contact(state_);
  exchange_.tool.write({.sequence = static_cast<std::uint64_t>(report_.ticks),
                        .time_ns = reading.time_ns,
                        .position_m = reading.position_m,
                        .triangle = at.triangle,
                        .in_contact = at.in_contact});
}

}  // namespace palpate
