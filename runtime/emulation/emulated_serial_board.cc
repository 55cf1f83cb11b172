#include "runtime/emulation/emulated_serial_board.h"

#include <algorithm>
#include <cerrno>

namespace palpate {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

}  // namespace

SerialBoard::SerialBoard(const SimulatedDeviceConfig& dynamics, const HandScript& hand,
                         const Eigen::Vector3d& start_m, std::size_t split_bytes,
                         std::size_t trace_max)
    : tool_(dynamics, hand, clock_, {.position_m = start_m}),
      split_bytes_(split_bytes),
      trace_max_(trace_max) {
  trace_.reserve(trace_max);
}

int SerialBoard::control(const UsbSetup& setup, std::int64_t /*now_ns*/) {
  return (setup.request_type & 0x60) == 0x20 ? 0 : -EPIPE;
}

DeviceReading SerialBoard::look() {
  if (!opened_) {
    tool_.open();
    opened_ = true;
  }
  DeviceReading at;
  static_cast<void>(tool_.read(at));
  return at;
}

void SerialBoard::push(const Eigen::Vector3d& force_n, std::int64_t now_ns) {
  static_cast<void>(tool_.write(force_n));
  if (trace_.size() < trace_max_) {
    trace_.push_back(motor_record(tool_, now_ns));
  }
}

int SerialBoard::receive(std::span<std::uint8_t> packet, std::int64_t now_ns) {
  if (waiting_.empty() || now_ns < ready_ns_) {
    return -EAGAIN;
  }
  const std::size_t count = std::min({packet.size(), split_bytes_, waiting_.size()});
  const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(count);
  std::copy(waiting_.begin(), end, packet.begin());
  waiting_.erase(waiting_.begin(), end);
  return static_cast<int>(count);
}

std::int64_t SerialBoard::next_ns(std::int64_t now_ns) {
  return waiting_.empty() ? now_ns + kMillisecond : ready_ns_;
}

}  // namespace palpate
