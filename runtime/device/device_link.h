// The seam between a device's protocol and the thread that speaks it.
#pragma once

#include <cstdint>
#include <string>

#include "runtime/device/device.h"

namespace palpate {

enum class LinkStatus : std::uint8_t {
  kOk,
  kMissed,  ///< no whole answer in time; the next call starts afresh
  kLost,    ///< gone for good
};

/// All calls from one thread, except name() and limits().
class DeviceLink {
 public:
  DeviceLink() = default;
  virtual ~DeviceLink() = default;
  DeviceLink(const DeviceLink&) = delete;
  DeviceLink& operator=(const DeviceLink&) = delete;

  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual DeviceLimits limits() const = 0;

  /// Ready, at zero force, positions known. @throws DeviceError saying what is missing;
  /// the device is then released.
  virtual void open() = 0;

  /// One exchange: a force [N] out, a position [m] in. Bounded time, no exception.
  [[nodiscard]] virtual LinkStatus transact(const Eigen::Vector3d& force_n,
                                            Eigen::Vector3d& position_m) noexcept = 0;

  /// Force [N] on the tool that the latest transact() sent. The force is less than
  /// transact() was given where the motors saturate or the pose has no transmission,
  /// zero where transact() sent none.
  [[nodiscard]] virtual Eigen::Vector3d sent_n() const noexcept = 0;

  /// Whether turn() is measured; known once it is open.
  [[nodiscard]] virtual bool measures_turns() const noexcept { return false; }

  /// The device's orientation with the latest position, by its own zero: a unit
  /// quaternion, device's axes from grip's.
  [[nodiscard]] virtual Eigen::Quaterniond turn() const noexcept {
    return Eigen::Quaterniond::Identity();
  }

  /// Zero force as far as the wire still exists, lights out, released.
  virtual void close() noexcept = 0;

  /// Why it was lost; empty if it was not.
  [[nodiscard]] virtual std::string failure() const = 0;
};

}  // namespace palpate
