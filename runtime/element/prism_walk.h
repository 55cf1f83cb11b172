// Where the tool is over the elements at hand.
#pragma once

#include <algorithm>
#include <cstddef>

#include <Eigen/Core>

#include "runtime/account/local_model.h"
#include "runtime/account/real.h"
#include "runtime/element/element_cache.h"
#include "runtime/element/prism.h"
#include "runtime/element/smooth_triangle.h"
#include "runtime/element/turned.h"

namespace palpate {

/// Where the tool is. Where that place is sound (`folded` false, `outside` false),
/// weights and height are continuous functions of the tool's position, whatever
/// elements lie between. Gradients of the smooth field are continuous, too.
struct FieldPlace {
  FieldKind kind = FieldKind::kSmooth;
  int slot = -1;                         ///< element in the cache; -1: none
  Vector3 position_m = Vector3::Zero();  ///< [m] of the tool
  Vector3 weight = Vector3::Zero();      ///< [-] w_j of the nodes, sum 1
  Turn turn = Turn::Zero();              ///< dw_j by the place's coordinates
  Real height_m = 0.0;                   ///< [m] s over the surface
  Vector3 normal = Vector3::Zero();      ///< [-] outward, unit
  Vector3 rise = Vector3::Zero();        ///< [-] gradient of s; on facets the normal
  bool folded = false;    ///< no sound coordinates: nearest point, its normal is held
  bool outside = false;   ///< beyond the element's edges, weights of its nearest point
  bool starved = false;   ///< outside, and the neighbour has not arrived
  Prism prism;            ///< of that element
  PrismPoint at;          ///< on facets; else where the element was entered
  PrismFrame frame;       ///< at `at`, on facets
  SmoothTriangle smooth;  ///< of the element, in the smooth field
};

/// n_a of a node, not below 0 [-]. @param a in [0, 3).
[[nodiscard]] inline Real weight_of(const FieldPlace& place, std::size_t a) noexcept {
  return std::max(Real(0.0), place.weight(static_cast<Eigen::Index>(a)));
}

/// A place at coordinates of its prism. @param frame there.
void set_facet(FieldPlace& place, const PrismPoint& at,
               const PrismFrame& frame) noexcept;

/// Gradient [per m] of a function with these derivatives by the place's coordinates,
/// and by the height.
[[nodiscard]] Vector3 gradient(const FieldPlace& place, const Vector3& slope,
                               Real by_height_per_m) noexcept;

/// The place on the surface at rest that is pressed [m]. On facets it is sum w_j v_j.
/// In the smooth field it is the tool's own place, projected onto the tangent planes of
/// the nodes: x - sum w_j n_j (n_j . (x - v_j)).
[[nodiscard]] Vector3 foot_m(const FieldPlace& place) noexcept;

/// Its derivatives by the place's coordinates, one per column.
[[nodiscard]] Matrix3 foot_turn(const FieldPlace& place) noexcept;

/// Takes the element in `slot`, at its point nearest to the tool, then follows the
/// tool.
void adopt(FieldPlace& place, const ElementCache& cache, int slot, const Vector3& x_m,
           FieldKind kind = FieldKind::kSmooth) noexcept;

/// Follows the tool to x_m from the present coordinates, through neighbours that the
/// cache holds and across triangles without area. Without a neighbour the element's
/// plane is continued (`outside`). Where the coordinates fold, the element nearest to
/// the tool on the way is kept, at its nearest point (`folded`).
void follow(FieldPlace& place, const ElementCache& cache, const Vector3& x_m) noexcept;

/// Follows the tool within the present element and its continued plane alone.
/// @returns false, the place unchanged, if it has no coordinates there.
[[nodiscard]] bool follow_within(FieldPlace& place, const Vector3& x_m) noexcept;

/// The same place in another copy of the same triangle, whose responses may be others.
void move_to_copy(FieldPlace& place, const ElementCache& cache, int slot) noexcept;

}  // namespace palpate
