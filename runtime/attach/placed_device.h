// Where in a body a device's workspace lies.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "runtime/device/device.h"
#include "runtime/hand/hand_script.h"

namespace palpate {

/// body = origin + rotation (device - centre). Rigid, so that work is the same in both.
struct Placement {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();      ///< [m] in the body
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();      ///< [m] of the device
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< device to body

  [[nodiscard]] Eigen::Vector3d to_body(
      const Eigen::Vector3d& device_m) const noexcept {
    return origin_m + rotation * (device_m - centre_m);
  }
  [[nodiscard]] Eigen::Vector3d to_device(
      const Eigen::Vector3d& body_m) const noexcept {
    return centre_m + rotation.transpose() * (body_m - origin_m);
  }
};

/// The device's centre lies clear_m above where the tool touches, its y axis along the
/// outward normal: a person presses down. @param right of the body, not along the
/// normal, which the device's x axis is as near to as it can be; zero: any.
[[nodiscard]] Placement placement_over(
    const HandScript& script, const Eigen::Vector3d& centre_m,
    const Eigen::Vector3d& right = Eigen::Vector3d::Zero());

/// A section of the body, for a device that moves in a plane.
struct SectionPlane {
  int axis = 2;           ///< [0, 2] of the body, along the plane's normal
  double offset_m = 0.0;  ///< [m] where the plane meets the axis
};

/// "x=0.01": across the body's x axis, 0.01 m from the origin. @throws InputError.
[[nodiscard]] SectionPlane parse_plane(const std::string& text);

/// The device's x-y plane is the section; its y axis is the outward normal's part in
/// it. @throws InputError where the surface is within 30 degrees of the plane, so that
/// nothing in the plane presses it.
[[nodiscard]] Placement placement_in(const SectionPlane& plane,
                                     const HandScript& script,
                                     const Eigen::Vector3d& centre_m);

/// The same motion as a hand makes it in the device's frame.
[[nodiscard]] HandScript in_device_frame(const HandScript& script,
                                         const Placement& placement);

/// A device whose positions and forces are those of the body's frame.
class PlacedDevice : public Device {
 public:
  PlacedDevice(std::unique_ptr<Device> device, const Placement& placement)
      : device_(std::move(device)), placement_(placement) {}

  [[nodiscard]] std::string name() const override { return device_->name(); }
  [[nodiscard]] DeviceLimits limits() const override { return device_->limits(); }
  [[nodiscard]] bool measures_turns() const override {
    return device_->measures_turns();
  }
  void open() override { device_->open(); }
  [[nodiscard]] DeviceStatus read(DeviceReading& reading) noexcept override {
    const Eigen::Quaterniond to_device =
        Eigen::Quaterniond(placement_.rotation).conjugate();
    DeviceReading inner{.position_m = placement_.to_device(reading.position_m),
                        .time_ns = reading.time_ns,
                        .turn = turned(reading.turn, to_device)};
    const DeviceStatus status = device_->read(inner);
    reading = {.position_m = placement_.to_body(inner.position_m),
               .time_ns = inner.time_ns,
               .withheld_n = placement_.rotation * inner.withheld_n,
               .read_ns = inner.read_ns,
               .turn = turned(inner.turn, to_device.conjugate())};
    return status;
  }
  [[nodiscard]] DeviceStatus write(const Eigen::Vector3d& force_n) noexcept override {
    return device_->write(placement_.rotation.transpose() * force_n);
  }
  void close() noexcept override { device_->close(); }
  [[nodiscard]] std::string failure() const override { return device_->failure(); }
  [[nodiscard]] const LinkReport* wire() const override { return device_->wire(); }

 private:
  // A turn in the axes that `axes` leads to.
  [[nodiscard]] static Eigen::Quaterniond turned(
      const Eigen::Quaterniond& turn, const Eigen::Quaterniond& axes) noexcept {
    Eigen::Quaterniond there;
    there.w() = turn.w();
    there.vec() = axes * turn.vec();
    return there;
  }

  std::unique_ptr<Device> device_;
  Placement placement_;
};

}  // namespace palpate
