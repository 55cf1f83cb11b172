// Points of a triangle by area coordinates (paper, (27)).
#pragma once

#include <Eigen/Core>

#include "runtime/account/real.h"

namespace palpate::triangle {

/// Area coordinates of the projection of p onto the triangle's plane; they sum to 1,
/// negative ones are outside. @param corner_m (3 x 3) one corner per column [m].
/// A triangle without area gives (1, 0, 0).
[[nodiscard]] Vector3 area_coordinates(const Matrix3& corner_m,
                                       const Vector3& p_m) noexcept;

/// Area coordinates, all in [0, 1], of the triangle's point nearest to the point of its
/// plane with coordinates `area`.
[[nodiscard]] Vector3 nearest_inside(const Matrix3& corner_m,
                                     const Vector3& area) noexcept;

/// Whether a triangle with these two edges has no area to speak of, against their
/// lengths.
[[nodiscard]] bool flat(const Vector3& edge1_m, const Vector3& edge2_m) noexcept;

}  // namespace palpate::triangle
