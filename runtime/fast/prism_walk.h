// Where the tool is in the prisms of the elements at hand.
#pragma once

#include <algorithm>
#include <cstddef>

#include <Eigen/Core>

#include "runtime/fast/element_cache.h"
#include "runtime/fast/prism.h"
#include "runtime/fast/real.h"

namespace palpate {

/// Coordinates of the tool. Where they are sound (`folded` false, `outside` false) they
/// are a continuous function of the tool's position, whatever the elements on the way.
struct FieldPlace {
  int slot = -1;  ///< element in the cache; -1: none
  Prism prism;    ///< of that element
  PrismPoint at;
  PrismFrame frame;      ///< at `at`
  bool folded = false;   ///< no sound coordinates: nearest point, its normal is held
  bool outside = false;  ///< beyond the element's edges, weights of its nearest point
  bool starved = false;  ///< outside, and the neighbour has not arrived
};

/// n_a of a node, not below 0 [-]. @param a in [0, 3).
[[nodiscard]] inline Real weight_of(const FieldPlace& place, std::size_t a) noexcept {
  return std::max(Real(0.0), place.frame.weight(static_cast<Eigen::Index>(a)));
}

/// Takes the element in `slot`, at its point nearest to the tool, then follows the
/// tool.
void adopt(FieldPlace& place, const ElementCache& cache, int slot,
           const Vector3& x_m) noexcept;

/// Follows the tool to x_m from the present coordinates, through neighbours that the
/// cache holds and across triangles without area. Without a neighbour the element's
/// plane is continued (`outside`). Where the coordinates fold, the element nearest to
/// the tool on the way is kept, at its nearest point (`folded`).
void follow(FieldPlace& place, const ElementCache& cache, const Vector3& x_m) noexcept;

/// Follows the tool within the present element and its continued plane alone.
/// @returns false, the place unchanged, if it has no coordinates there.
[[nodiscard]] bool follow_within(FieldPlace& place, const Vector3& x_m) noexcept;

/// The same place in another copy of the same triangle.
void move_to_copy(FieldPlace& place, const ElementCache& cache, int slot) noexcept;

}  // namespace palpate
