#include "formats/response/displaced_surface.h"

#include <cstddef>

namespace palpate {

Eigen::Index deepest_field(const DisplacementField& field, std::int32_t node) {
  Eigen::Index best = -1;
  double deepest_m = 0.0;
  for (std::size_t j = 0; j < field.node.size(); ++j) {
    if (field.node[j] == node && field.depth_m[j] > deepest_m) {
      deepest_m = field.depth_m[j];
      best = static_cast<Eigen::Index>(j);
    }
  }
  return best;
}

Points displaced_m(const DisplacementField& field,
                   std::span<const PressedField> pressed) {
  Eigen::VectorXd coefficient = Eigen::VectorXd::Zero(field.basis.cols());
  for (const PressedField& each : pressed) {
    coefficient += each.depth_m / field.depth_m[static_cast<std::size_t>(each.row)] *
                   field.coefficient.row(each.row).transpose().cast<double>();
  }
  Points moved_m(field.basis.rows() / 3, 3);
  for (Eigen::Index i = 0; i < field.basis.rows(); ++i) {
    moved_m(i / 3, i % 3) =
        field.basis.row(i).transpose().cast<double>().dot(coefficient);
  }
  return moved_m;
}

}  // namespace palpate
