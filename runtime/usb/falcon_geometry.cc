#include "runtime/usb/falcon_geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

namespace palpate {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::array<double, 3> kAzimuth{105.0 * kDegree, -15.0 * kDegree,
                                         -135.0 * kDegree};
constexpr double kFirstAngle = 35.0 * kDegree;    // theta1 at count 0
constexpr double kPerCount = 0.036435 * kDegree;  // 9880.7 counts per turn of a leg
constexpr double kStepMax = 0.02;                 // [m]
constexpr double kConverged = 1e-10;              // [m]
constexpr int kIterations = 32;

struct Leg {
  double theta1 = 0.0;
  Eigen::RowVector3d rate = Eigen::RowVector3d::Zero();
};

bool solve_leg(const Eigen::Vector3d& p, double phi, Leg& leg) noexcept {
  const double a = 0.060;  // [m]
  const double b = 0.1025;
  const double c = 0.01443;
  const double d = 0.01125;
  const double e = 0.01125;
  const double f = -0.025;
  const double r = 0.040;
  const double s = -0.02309;
  const double cos_phi = std::cos(phi);
  const double sin_phi = std::sin(phi);
  const double u = cos_phi * p.x() + sin_phi * p.y() - r;
  const double v = -sin_phi * p.x() + cos_phi * p.y() - s;
  const double w = p.z();
  const double cos3 = (v + f) / b;
  if (!(std::abs(cos3) <= 1.0)) {
    return false;
  }
  const double sin3 = std::sqrt(1.0 - cos3 * cos3);
  const double L = d + e + b * sin3;
  // With theta1's tan(theta1 / 2) = t, (u + c - a cos)^2 + (w - a sin)^2 = L^2 becomes
  // l2 t^2 + l1 t + l0 = 0.
  const double K = w * w + u * u + 2.0 * c * u + c * c + a * a - L * L;
  const double l0 = K - 2.0 * a * (u + c);
  const double l1 = -4.0 * a * w;
  const double l2 = K + 2.0 * a * (u + c);
  const double discriminant = l1 * l1 - 4.0 * l0 * l2;
  const double denominator = -l1 + std::sqrt(std::max(discriminant, 0.0));
  if (!(discriminant >= 0.0) || !(denominator > 0.0)) {
    return false;
  }
  // (-l1 - sqrt(..)) / (2 l2), written so that l2 may vanish.
  leg.theta1 = 2.0 * std::atan(2.0 * l0 / denominator);
  const double theta2 =
      std::atan2(w - a * std::sin(leg.theta1), u + c - a * std::cos(leg.theta1));
  const double D = -a * sin3 * std::sin(leg.theta1 - theta2);
  const double du = std::cos(theta2) * sin3 / D;
  const double dv = cos3 / D;
  leg.rate << cos_phi * du - sin_phi * dv, sin_phi * du + cos_phi * dv,
      std::sin(theta2) * sin3 / D;
  return leg.rate.allFinite();
}

}  // namespace

bool inverse(const Eigen::Vector3d& position_m, FalconPose& pose) noexcept {
  FalconPose found;
  for (Eigen::Index i = 0; i < 3; ++i) {
    Leg leg;
    if (!solve_leg(position_m, kAzimuth[static_cast<std::size_t>(i)], leg)) {
      return false;
    }
    found.theta1[i] = leg.theta1;
    found.rates.row(i) = leg.rate;
  }
  pose = found;
  return true;
}

FalconForward forward(const Eigen::Vector3d& theta1_rad,
                      const Eigen::Vector3d& start_m) noexcept {
  FalconForward result;
  result.position_m = start_m;
  if (!inverse(start_m, result.pose)) {
    result.position_m = falcon_centre_m();
    if (!inverse(result.position_m, result.pose)) {
      return result;
    }
  }
  while (result.iterations < kIterations) {
    ++result.iterations;
    // Newton's step for theta1(position) = theta1_rad: rates is d theta1 / d position.
    const Eigen::Vector3d step =
        result.pose.rates.inverse() * Eigen::Vector3d(theta1_rad - result.pose.theta1);
    const double length = step.norm();
    if (!std::isfinite(length)) {
      return result;
    }
    double scale = length > kStepMax ? kStepMax / length : 1.0;
    // Halved until all legs reach.
    while (!inverse(result.position_m + scale * step, result.pose)) {
      scale *= 0.5;
      if (scale < 1e-9) {
        return result;
      }
    }
    result.position_m += scale * step;
    if (scale * length < kConverged) {
      // A step that had to be cut says nothing of how near the solution is.
      result.converged = scale == 1.0;
      return result;
    }
  }
  return result;
}

Eigen::Vector3d angles_of(const std::array<std::int16_t, 3>& counts) noexcept {
  return {kFirstAngle + kPerCount * counts[0], kFirstAngle + kPerCount * counts[1],
          kFirstAngle + kPerCount * counts[2]};
}

std::array<std::int16_t, 3> counts_of(const Eigen::Vector3d& theta1_rad) noexcept {
  std::array<std::int16_t, 3> counts{};
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double count = std::round((theta1_rad[i] - kFirstAngle) / kPerCount);
    counts[static_cast<std::size_t>(i)] =
        static_cast<std::int16_t>(std::clamp(count, -32768.0, 32767.0));
  }
  return counts;
}

}  // namespace palpate
