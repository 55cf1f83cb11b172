#include "runtime/emulation/emulated_serial_board.h"

#include <algorithm>
#include <cerrno>

namespace palpate {
SerialBoard::SerialBoard(const SimulatedDeviceConfig& dynamics, const HandScript& hand,
                         const Eigen::Vector3d& start_m, std::size_t split_bytes,
                         std::size_t trace_max)
    : tool_(dynamics, hand, port.clock, {.position_m = start_m}),
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
  if (port.waiting.empty() || now_ns < port.ready_ns) {
    return -EAGAIN;
  }
  const std::size_t count =
      std::min({packet.size(), split_bytes_, port.waiting.size()});
  const auto end = port.waiting.begin() + static_cast<std::ptrdiff_t>(count);
  std::copy(port.waiting.begin(), end, packet.begin());
  port.waiting.erase(port.waiting.begin(), end);
  return static_cast<int>(count);
}

std::int64_t SerialBoard::next_ns(std::int64_t now_ns) {
  return port.waiting.empty() ? now_ns + kMillisecondNs : port.ready_ns;
}

}  // namespace palpate
