// How a better solution differs from a linear one along a path, between the depths
// where both are known.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace palpate {

/// A vector function of the penetration, zero at `from_m`, through its knots:
/// shape-preserving cubic (Fritsch and Butland 1984), constant beyond the last knot.
class RelativeCorrection {
 public:
  struct Knot {
    double penetration_m = 0.0;
    Eigen::Vector3d value = Eigen::Vector3d::Zero();
  };

  /// @param knots (k >= 1), of penetrations that grow, above from_m.
  RelativeCorrection(double from_m, std::span<const Knot> knots);

  [[nodiscard]] Eigen::Vector3d at(double penetration_m) const;

 private:
  std::vector<Knot> knot_;
  std::vector<Eigen::Vector3d> slope_;
};

}  // namespace palpate
