#include "runtime/usb/pantograph.h"

#include <cmath>

#include <Eigen/LU>
#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kInLine = 1e-6;

Eigen::Vector2d base(const PantographLinks& links, Eigen::Index i) noexcept {
  return {(i == 0 ? 0.5 : -0.5) * links.base_m, 0.0};
}

Eigen::Vector2d unit(double angle) noexcept {
  return {std::cos(angle), std::sin(angle)};
}

Eigen::Vector2d turned(const Eigen::Vector2d& v) noexcept {
  return {-v.y(), v.x()};
}

}  // namespace

void check(const PantographLinks& links) {
  const bool lengths = links.driven_m > 0.0 && links.free_m > 0.0 &&
                       links.base_m >= 0.0 &&
                       std::isfinite(links.driven_m + links.free_m + links.base_m);
  if (!lengths) {
    throw InputError(
        fmt::format("pantograph: links are {}, {} and {} m (driven, free, base), the "
                    "first two must "
                    "be positive, the last not negative",
                    links.driven_m, links.free_m, links.base_m));
  }
  if (std::abs(links.side) != 1 || std::abs(links.elbow) != 1) {
    throw InputError(
        fmt::format("pantograph: side is {}, elbow {}, each must be 1 or -1",
                    links.side, links.elbow));
  }
}

bool forward(const PantographLinks& links, const Eigen::Vector2d& theta_rad,
             PantographPose& pose) noexcept {
  const Eigen::Vector2d e1 = base(links, 0) + links.driven_m * unit(theta_rad[0]);
  const Eigen::Vector2d e2 = base(links, 1) + links.driven_m * unit(theta_rad[1]);
  // The tool lies on the perpendicular through the middle of the elbows; from the
  // second elbow to the first it is turned by +90 degrees for side +1.
  const Eigen::Vector2d half = 0.5 * (e1 - e2);
  const double reach2 = links.free_m * links.free_m - half.squaredNorm();
  const double apart = half.norm();
  if (!(reach2 > 0.0) || !(apart > kInLine * links.free_m)) {
    return false;
  }
  PantographPose found{.theta = theta_rad};
  found.position_m =
      0.5 * (e1 + e2) + links.side * std::sqrt(reach2) / apart * turned(half);
  Eigen::Matrix2d W;
  W.row(0) = (found.position_m - e1).transpose();
  W.row(1) = (found.position_m - e2).transpose();
  found.transmission = std::abs(W.determinant()) / (links.free_m * links.free_m);
  if (!(found.transmission > kInLine)) {
    return false;
  }
  const Eigen::Vector2d drive =
      links.driven_m *
      Eigen::Vector2d(W.row(0).dot(turned(unit(theta_rad[0])).transpose()),
                      W.row(1).dot(turned(unit(theta_rad[1])).transpose()));
  found.jacobian = W.inverse() * drive.asDiagonal();
  pose = found;
  return true;
}

bool inverse(const PantographLinks& links, const Eigen::Vector2d& position_m,
             Eigen::Vector2d& theta_rad) noexcept {
  Eigen::Vector2d found;
  for (Eigen::Index i = 0; i < 2; ++i) {
    const Eigen::Vector2d to = position_m - base(links, i);
    const double distance = to.norm();
    const double l = links.driven_m;
    const double cosine = (l * l + distance * distance - links.free_m * links.free_m) /
                          (2.0 * l * distance);
    if (!(std::abs(cosine) <= 1.0)) {
      return false;
    }
    // The right leg's elbow is outwards when it is clockwise of the tool's direction.
    const double outwards = i == 0 ? -1.0 : 1.0;
    const double angle = std::atan2(to.y(), to.x()) +
                         outwards * links.side * links.elbow * std::acos(cosine);
    found[i] = std::atan2(std::sin(angle), std::cos(angle));
  }
  theta_rad = found;
  return true;
}

Eigen::Vector2d torques_for(const PantographPose& pose, const Eigen::Vector2d& force_n,
                            double torque_max_nm) noexcept {
  Eigen::Vector2d torque = pose.jacobian.transpose() * force_n;
  if (!(pose.transmission >= kTransmissionMin) || !torque.allFinite()) {
    return Eigen::Vector2d::Zero();
  }
  const double largest = torque.cwiseAbs().maxCoeff();
  return largest > torque_max_nm ? Eigen::Vector2d(torque * (torque_max_nm / largest))
                                 : torque;
}

Eigen::Vector2d force_of(const PantographPose& pose,
                         const Eigen::Vector2d& torque_nm) noexcept {
  const Eigen::Vector2d force = pose.jacobian.inverse().transpose() * torque_nm;
  return force.allFinite() ? force : Eigen::Vector2d::Zero();
}

}  // namespace palpate
