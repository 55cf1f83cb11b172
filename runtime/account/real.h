// The scalar of the fast step: double, unless PALPATE_REAL says float, for processors
// whose floating-point unit has single precision alone. It is one for a whole program.
//
// With float, GCC needs -fsingle-precision-constant, so that a literal is none of
// double's. The ledger's sums stay in double: they grow for hours, and a step adds to
// them a few times only.
#pragma once

#include <cmath>

#include <Eigen/Core>

#ifndef PALPATE_REAL
#define PALPATE_REAL double
#endif

namespace palpate {

using Real = PALPATE_REAL;
using Vector2 = Eigen::Matrix<Real, 2, 1>;
using Vector3 = Eigen::Matrix<Real, 3, 1>;
using Matrix3 = Eigen::Matrix<Real, 3, 3>;

/// A tolerance of rounding, in the precision of Real.
[[nodiscard]] constexpr Real rounding(double in_double, double in_float) noexcept {
  return static_cast<Real>(sizeof(Real) == sizeof(double) ? in_double : in_float);
}

/// The largest Real that is not above a value >= 0: what may be spent of a sum.
[[nodiscard]] inline Real not_above(double value) noexcept {
  const auto nearest = static_cast<Real>(value);
  return static_cast<double>(nearest) <= value ? nearest
                                               : std::nextafter(nearest, Real(0));
}

}  // namespace palpate
