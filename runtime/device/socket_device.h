// A device that another process drives: it sits at a local socket, and a guardian
// stands between it and what may happen to this process.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "runtime/device/device.h"
#include "runtime/device/guardian.h"
#include "runtime/device/link_report.h"

namespace palpate {

/// The protocol (SOCKET.md beside this file has it for drivers in other languages):
/// datagrams in order (SOCK_SEQPACKET), host byte order, distinguished by their size.
/// The driver process sends one hello, then a state whenever it has measured one, with
/// its orientation where its hello was kTurnedHello. The renderer sends commands. A
/// command acts until the next. The driver ends when the socket does, and puts the
/// force to zero if the last command did not. Before it ends by itself it may say why.
constexpr std::array<char, 8> kHello{'p', 'a', 'l', 'p', 'd', 'e', 'v', '2'};
constexpr std::array<char, 8> kTurnedHello{'p', 'a', 'l', 'p', 'd', 'e', 'v', '3'};

struct SocketHello {
  std::array<char, 8> magic = kHello;
  double damping_n_s_per_m = 0.0;
  double coulomb_n = 0.0;
  double resolution_m = 0.0;
  double delay_s = 0.0;
  double force_max_n = 0.0;
};

struct SocketState {
  std::int64_t time_ns = 0;            ///< CLOCK_MONOTONIC; measured no earlier
  std::array<double, 3> position_m{};  ///< [m]
  std::array<double, 3> withheld_n{};  ///< [N] DeviceReading's, of that command:
  std::uint64_t sequence = 0;          ///< of the command that acts; 0: zero force
  std::int64_t done_ns = 0;            ///< when that was known; measured no later
  std::uint64_t missed = 0;            ///< exchanges without an answer so far
};

struct SocketTurnedState {
  SocketState state;
  /// DeviceReading's turn; exact_turn() of it is used, what has none ends the run.
  std::array<double, 4> turn_wxyz{1.0, 0.0, 0.0, 0.0};
};

struct SocketFarewell {
  std::array<char, 8> magic{'p', 'a', 'l', 'p', 'b', 'y', 'e', '2'};
  std::array<char, 248> why{};  ///< UTF-8, ends with a zero
};

struct SocketCommand {
  std::uint64_t sequence = 0;       ///< counts from 1; 0: from the guardian
  std::array<double, 3> force_n{};  ///< [N]
};

/// How long to wait for a driver.
struct SocketPatience {
  double silent_s = 0.1;  ///< [s] > 0 without write(): zero force, for good
  double hello_s = 2.0;   ///< [s] > 0
  double stale_s = 0.01;  ///< [s] > 0 without a state: the last is no answer any more
  std::function<bool()> stopped{};  ///< while it waits for the hello; empty: never
};

/// To be opened once. Commands beat the guardian's watch; it is forked in open() and
/// sends zero force if this process dies or writes nothing for `silent_s`. After that
/// write() says kLost.
class SocketDevice : public Device {
 public:
  /// Connects and waits for the hello. Then looks for a tenth of a second at most how
  /// long the driver's wire holds a force (limits()). The measure is the median time
  /// from one state to the next.
  /// @throws DeviceError; Interrupted when stopped.
  explicit SocketDevice(const std::filesystem::path& socket,
                        const SocketPatience& patience = {});

  /// Takes over a connected descriptor.
  explicit SocketDevice(int descriptor, const SocketPatience& patience = {});
  ~SocketDevice() override;

  [[nodiscard]] std::string name() const override { return "socket"; }
  [[nodiscard]] DeviceLimits limits() const override { return limits_; }
  [[nodiscard]] bool measures_turns() const override { return turned_; }
  void open() override;
  [[nodiscard]] DeviceStatus read(DeviceReading& reading) noexcept override;
  [[nodiscard]] DeviceStatus write(const Eigen::Vector3d& force_n) noexcept override;
  void close() noexcept override;
  [[nodiscard]] std::string failure() const override;
  [[nodiscard]] const LinkReport* wire() const override { return &report_; }

 private:
  // A command that was written, until the driver says that another acts.
  struct Written {
    std::uint64_t sequence = 0;
    std::int64_t measured_ns = 0;  // the position that it answers
    bool zero = true;
  };
  static constexpr std::size_t kWrittenMax = 256;

  void greet();
  void look_at_wire();
  [[nodiscard]] DeviceStatus read(DeviceReading& reading, int states_max) noexcept;
  void take(const SocketState& state) noexcept;
  [[nodiscard]] bool take(const SocketTurnedState& turned) noexcept;

  int descriptor_ = -1;
  SocketPatience patience_;
  DeviceLimits limits_;
  bool turned_ = false;  // states are SocketTurnedState
  std::uint64_t sequence_ = 0;
  std::unique_ptr<Guardian> guardian_;  // while open
  DeviceReading latest_;
  std::int64_t heard_ns_ = 0;  // the latest state; 0: none yet
  std::int64_t opened_ns_ = 0;
  std::uint64_t acting_ = 0;  // sequence
  std::array<Written, kWrittenMax> written_{};
  LinkReport report_;
  const char* failure_ = "";
  SocketFarewell farewell_{};
};

}  // namespace palpate
