#include "runtime/device/device_turn.h"

#include <cmath>

namespace palpate {

std::optional<Eigen::Quaterniond> exact_turn(const Eigen::Quaterniond& said) noexcept {
  const double norm = said.norm();
  if (!(std::abs(norm - 1.0) <= kTurnTolerance)) {
    return std::nullopt;
  }
  return Eigen::Quaterniond(said.coeffs() / norm);
}

std::optional<Eigen::Quaterniond> exact_turn(const Eigen::Matrix3d& said) noexcept {
  const Eigen::Matrix3d off = said.transpose() * said - Eigen::Matrix3d::Identity();
  // allFinite() first: a maximum passes over what is no number.
  if (!said.allFinite() || !(off.cwiseAbs().maxCoeff() <= kTurnTolerance) ||
      !(said.determinant() > 0.0)) {
    return std::nullopt;
  }
  return Eigen::Quaterniond(said).normalized();
}

}  // namespace palpate
