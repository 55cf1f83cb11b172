// A haptic device: where the tool is, and the force on the hand that holds it.
//
// Who puts the force to zero:
//
// Any device: close(), at the end of a run, after SIGINT, SIGTERM or SIGHUP, after a
// latched fault, and when an exception passes by.
//
// Simulated: it lives in this process. Killed, crashed or hanging, it pushes nobody.
//
// Socket, a driver in a process of its own (socket_device.h; driven_device.h starts
// it). After SIGKILL or a crash a guardian process (guardian.h) does, as soon as the
// kernel closes this process's end. When the fast thread hangs, the guardian does after
// 9/8 of its patience, and for good. If the guardian is killed, the renderer stops; if
// both are, the driver sees the end of its socket.
//
// USB (threaded_device.h): the thread that speaks to the device, when the fast thread
// falls silent, ends or faults. Nothing that we know of says that their firmware drops
// the force when the host is gone. After SIGKILL or a crash, and when that thread
// hangs, a guardian process that shares the open usbfs file writes zero force
// (usb_guardian.h). When the wire is cut, what the firmware does is all there is.
//
// Against a power failure of the computer only a watchdog in the device itself helps.
#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate {

struct LinkReport;

/// [s] A frame of USB at full speed, and the period of services' and vendors' loops.
constexpr double kUsualHoldS = 1e-3;

/// What a device can render, for the stability bounds.
struct DeviceLimits {
  double damping_n_s_per_m =
      0.0;                    ///< [N s/m] [0, inf) viscous, smallest of any direction
  double coulomb_n = 0.0;     ///< [N] [0, inf) friction of the mechanism
  double resolution_m = 0.0;  ///< [m] [0, inf) step of the measured position
  double delay_s = 0.0;       ///< [s] [0, inf) from command to force
  double hold_s = 0.0;        ///< [s] [0, inf) that its wire holds a force at least
  double force_max_n = 0.0;   ///< [N] (0, inf) whole vector
};

struct DeviceReading {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< [m] tool reference point
  std::int64_t time_ns = 0;  ///< [ns] monotonic clock, when it was measured
  /// [N] of the latest force, what the driver could not render: motors that saturate, a
  /// pose without transmission, an exchange that was missed. Force on the tool =
  /// written
  /// - withheld.
  Eigen::Vector3d withheld_n = Eigen::Vector3d::Zero();
  /// [ns] likewise, when it was read: a driver may have kept it. 0: when measured.
  std::int64_t read_ns = 0;
  /// The tool from its orientation when upright, where the device measures it; a device
  /// that does not leaves it.
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
};

enum class DeviceStatus : std::uint8_t {
  kOk,
  kLate,  ///< no answer in time: the last reading stays valid, the force may be stale
  kLost,  ///< gone for good; every further call says so again
};

/// The seam to hardware. All that may fail with a message is in open(); read() and
/// write() belong to the fast loop: no exception, no allocation, bounded time.
class Device {
 public:
  Device() = default;
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual DeviceLimits limits() const = 0;

  /// Whether its readings' turns are measured; known once it is open, and kept after.
  [[nodiscard]] virtual bool measures_turns() const { return false; }

  /// Ready to read, at zero force. @throws DeviceError saying what is missing.
  virtual void open() = 0;

  [[nodiscard]] virtual DeviceStatus read(DeviceReading& reading) noexcept = 0;

  /// Holds force_n [N] on the tool until the next write.
  [[nodiscard]] virtual DeviceStatus write(const Eigen::Vector3d& force_n) noexcept = 0;

  /// Zero force, then gone. Any number of times, in any state.
  virtual void close() noexcept = 0;

  /// Why read() or write() said kLost, for people; empty if there is nothing to say.
  [[nodiscard]] virtual std::string failure() const { return ""; }

  /// The account of the wire (threaded_device.h), after close(); null without one.
  [[nodiscard]] virtual const LinkReport* wire() const { return nullptr; }
};

/// Closes a device on every way out of a scope.
class DeviceSession {
 public:
  /// @throws DeviceError from open().
  explicit DeviceSession(Device& device) : device_(device) { device_.open(); }
  ~DeviceSession() { device_.close(); }
  DeviceSession(const DeviceSession&) = delete;
  DeviceSession& operator=(const DeviceSession&) = delete;

 private:
  Device& device_;
};

}  // namespace palpate
