// Places over an element, for who looks at a field all over.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "runtime/element/element.h"

namespace palpate {

struct OverElement {
  Eigen::Vector3d foot_m = Eigen::Vector3d::Zero();  ///< [m] on the flat element
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< [-] unit, between the nodes'

  [[nodiscard]] Eigen::Vector3d at(double height_m) const {
    return foot_m + height_m * normal;
  }
};

/// @param share [-] of the nodes, sum 1. The normal is zero where theirs cancel.
[[nodiscard]] inline OverElement over_element(const Element& element,
                                              const Eigen::Vector3d& share) {
  OverElement over;
  for (std::size_t j = 0; j < 3; ++j) {
    const double w = share(static_cast<Eigen::Index>(j));
    const ElementNode& node = element.node[j];
    over.foot_m += w * Eigen::Map<const Eigen::Vector3d>(node.position_m.data());
    over.normal += w * Eigen::Map<const Eigen::Vector3d>(node.normal.data());
  }
  over.normal.normalize();
  return over;
}

}  // namespace palpate
