#include "runtime/usb/falcon_motors.h"

#include <cmath>

#include <Eigen/LU>

namespace palpate {

FalconMotors motors_for(const Eigen::Vector3d& force_n, const Eigen::Matrix3d& rates,
                        double calibration) noexcept {
  FalconMotors motors;
  Eigen::Vector3d counts = kFalconCountsPerNewtonMetre * calibration *
                           (rates.inverse().transpose() * force_n);
  if (!counts.allFinite()) {
    return motors;
  }
  const double largest = counts.cwiseAbs().maxCoeff();
  if (largest > kFalconMotorMax) {
    counts *= kFalconMotorMax / largest;
    motors.clamped = true;
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    motors.command[static_cast<std::size_t>(i)] =
        static_cast<std::int16_t>(std::lround(counts[i]));
  }
  return motors;
}

Eigen::Vector3d force_of(const std::array<std::int16_t, 3>& command,
                         const Eigen::Matrix3d& rates, double calibration) noexcept {
  const Eigen::Vector3d counts(command[0], command[1], command[2]);
  return rates.transpose() * counts / (kFalconCountsPerNewtonMetre * calibration);
}

}  // namespace palpate
