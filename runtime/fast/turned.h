// Values at a place of an element, and how they change with it.
#pragma once

#include <Eigen/Core>

#include "runtime/fast/real.h"

namespace palpate {

using Turn = Eigen::Matrix<Real, 3, 2>;  ///< dw/dn_1 and dw/dn_2, n_0 giving way

/// A value at the place, and its derivatives by n_1 and n_2.
template <typename Value>
struct Turned {
  Value value;
  Value by_n1;
  Value by_n2;
};

[[nodiscard]] inline Vector2 slope_of(const Turned<Real>& value) noexcept {
  return {value.by_n1, value.by_n2};
}

}  // namespace palpate
