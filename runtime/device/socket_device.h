// A device that another process drives: it sits at a local socket, and a guardian
// stands between it and what may happen to this process.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "runtime/device/device.h"
#include "runtime/device/guardian.h"

namespace palpate {

/// The protocol: datagrams in order (SOCK_SEQPACKET), host byte order. The driver
/// process sends one hello, then a state whenever it has measured one; the renderer
/// sends commands. A command acts until the next. The driver ends when the socket does,
/// and puts the force to zero if the last command did not.
struct SocketHello {
  std::array<char, 8> magic{'p', 'a', 'l', 'p', 'd', 'e', 'v', '1'};
  double damping_n_s_per_m = 0.0;
  double coulomb_n = 0.0;
  double resolution_m = 0.0;
  double delay_s = 0.0;
  double force_max_n = 0.0;
};

struct SocketState {
  std::int64_t time_ns = 0;            ///< CLOCK_MONOTONIC, when it was measured
  std::array<double, 3> position_m{};  ///< [m]
};

struct SocketCommand {
  std::uint64_t sequence = 0;       ///< counts from 1; 0: from the guardian
  std::array<double, 3> force_n{};  ///< [N]
};

/// To be opened once. Commands beat the guardian's watch; it is forked in open() and
/// sends zero force if this process dies or writes nothing for `silent_s`. After that
/// write() says kLost.
class SocketDevice : public Device {
 public:
  /// Connects and waits for the hello, at most 2 s. @throws DeviceError.
  explicit SocketDevice(const std::filesystem::path& socket, double silent_s = 0.1);

  /// Takes over a connected descriptor.
  explicit SocketDevice(int descriptor, double silent_s = 0.1);
  ~SocketDevice() override;

  [[nodiscard]] std::string name() const override { return "socket"; }
  [[nodiscard]] DeviceLimits limits() const override { return limits_; }
  void open() override;
  [[nodiscard]] DeviceStatus read(DeviceReading& reading) noexcept override;
  [[nodiscard]] DeviceStatus write(const Eigen::Vector3d& force_n) noexcept override;
  void close() noexcept override;

 private:
  void greet();

  int descriptor_ = -1;
  double silent_s_;
  DeviceLimits limits_;
  std::uint64_t sequence_ = 0;
  std::unique_ptr<Guardian> guardian_;  // while open
};

}  // namespace palpate
