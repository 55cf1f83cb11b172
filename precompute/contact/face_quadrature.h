// Where contact is sampled on a quadratic face: 24 points, with the values of the six
// pressure hats and of the six shape functions there.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace palpate {

/// Face nodes: corners 0 1 2, then the middles of (0,1) (1,2) (2,0). Those of the four
/// sub-triangles, all of equal area.
inline constexpr std::array<std::array<int, 3>, 4> kSubTriangle{
    {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};

/// A point of the rule. Hats are piecewise linear on the four sub-triangles, shapes
/// quadratic.
struct FaceRulePoint {
  Eigen::Vector3d at;                 ///< [-] barycentric
  double area_share = 0.0;            ///< [-] weight; all sum to 1
  Eigen::Matrix<double, 6, 1> hat;    ///< [-] sums to 1
  Eigen::Matrix<double, 6, 1> shape;  ///< [-] sums to 1
};

/// The degree-4 rule of Strang and Fix (1973) on each of the four sub-triangles.
[[nodiscard]] const std::vector<FaceRulePoint>& face_rule();

}  // namespace palpate
