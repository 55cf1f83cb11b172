// Values at a place of an element, and how they change with it.
#pragma once

#include <Eigen/Core>

#include "runtime/account/real.h"

namespace palpate {

/// dw_j (rows) by the place's three coordinates (columns). In the smooth field these
/// are those of space [1/m]. On facets they are n_1 and n_2 [-], with n_0 compensating;
/// facets have no third.
using Turn = Matrix3;

/// A value at the place, and its derivatives by the same coordinates.
template <typename Value>
struct Turned {
  Value value;
  Value by_1;
  Value by_2;
  Value by_3;
};

[[nodiscard]] inline Vector3 slope_of(const Turned<Real>& value) noexcept {
  return {value.by_1, value.by_2, value.by_3};
}

}  // namespace palpate
