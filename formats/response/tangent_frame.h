// Axes in the plane across a direction. Header only, for the fast step too.
#pragma once

#include <Eigen/Core>

namespace palpate {

/// x and y after the least turn that takes z to a direction (turn_from_z.h), in columns
/// (3 x 2). They are x - n_x (z + n) / (1 + n_z), and y likewise. Along -z: x and -y.
/// @param n unit.
template <typename Real>
[[nodiscard]] Eigen::Matrix<Real, 3, 2> tangent_frame(
    const Eigen::Matrix<Real, 3, 1>& n) noexcept {
  constexpr Real kTurnedOver = static_cast<Real>(sizeof(Real) == 8 ? 1e-12 : 1e-5);
  const Real up = Real(1) + n.z();
  Eigen::Matrix<Real, 3, 2> frame = Eigen::Matrix<Real, 3, 2>::Zero();
  frame(0, 0) = Real(1);
  frame(1, 1) = Real(1);
  if (!(up > kTurnedOver)) {
    frame(1, 1) = Real(-1);
    return frame;
  }
  for (Eigen::Index i = 0; i < 2; ++i) {
    const Real part = n(i) / up;
    frame.col(i) -= part * n;
    frame(2, i) -= part;
  }
  return frame;
}

}  // namespace palpate
