// A simulated hand that wanders over a body at a constant speed, pressing all the time.
// The hand meets the body's places in an order that nobody knows beforehand.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "formats/mesh/surface_search.h"
#include "runtime/device/device.h"
#include "runtime/hand/hand_script.h"
#include "runtime/hand/simulated_device.h"

namespace palpate {

struct WanderOptions {
  double speed_m_per_s = 0.05;  ///< [m/s] > 0 along the surface
  double touch_m = 0.0;         ///< [m] height of the reference point at touch
  double press_m = 0.002;       ///< [m] > 0 the hand's depth below touch
  double clear_m = 0.01;        ///< [m] > 0 height above touch where it begins ...
  double lower_s = 0.5;         ///< [s] > 0 ... and the time until it is pressed in
  double turn_rad_per_s = 2.0;  ///< [rad/sqrt(s)] by which its heading drifts
  std::uint32_t seed = 1;
};

class WanderingHand {
 public:
  /// Body and normals must outlive it. Begins over the highest place whose triangle may
  /// be visited: one with three nodes of `open`. @throws InputError if there is none.
  WanderingHand(const SurfaceMesh& body, const Points& normal, std::vector<bool> open,
                const WanderOptions& options);

  void advance(double dt_s);  ///< [s] > 0, small: speed times it is a step

  /// Stays in place, so that a device may keep hold of it.
  [[nodiscard]] const HandTarget& target() const noexcept { return target_; }

 private:
  [[nodiscard]] bool is_open(std::int32_t triangle) const;
  void aim(double dt_s);

  const SurfaceMesh& body_;
  const Points& normal_;
  std::vector<bool> open_;
  WanderOptions o_;
  SurfaceSearch search_;
  std::mt19937_64 random_;
  std::normal_distribution<double> drift_;
  SurfacePoint at_;
  Eigen::Vector3d outward_ = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d heading_ = Eigen::Vector3d::UnitX();
  double time_s_ = 0.0;
  HandTarget target_;
};

/// The simulated device in that hand.
class WanderingDevice : public Device {
 public:
  WanderingDevice(const SimulatedDeviceConfig& config, WanderingHand hand,
                  Clock& clock);

  [[nodiscard]] std::string name() const override { return "simulated"; }
  [[nodiscard]] DeviceLimits limits() const override { return device_.limits(); }
  void open() override;
  [[nodiscard]] DeviceStatus read(DeviceReading& reading) noexcept override;
  [[nodiscard]] DeviceStatus write(const Eigen::Vector3d& force_n) noexcept override {
    return device_.write(force_n);
  }
  void close() noexcept override { device_.close(); }

 private:
  WanderingHand hand_;
  Clock& clock_;
  std::int64_t advanced_ns_ = 0;
  SimulatedDevice device_;
};

}  // namespace palpate
