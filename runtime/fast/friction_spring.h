// Coulomb friction of a contact on the potential field, as a spring in its tangent
// plane.
//
// k_t |delta_t|^2 / 2 with k_t = mu F_n / delta_L, delta_t the movement of the contact
// in the plane since it stuck, at most delta_L. The spring turns with the plane and
// keeps its length, so it stores the same. Where k_t grows, the anchor follows so that
// the spring stores no more, |delta_t| sqrt(k_t) constant (23). Where k_t falls, the
// energy that the spring gives up is lost.
#pragma once

#include "runtime/account/real.h"
#include "runtime/element/element_cache.h"
#include "runtime/element/prism_walk.h"

namespace palpate {

struct FrictionSpring {
  Real n_per_m = 0.0;                   ///< [N/m] k_t >= 0
  Vector3 stretch_m = Vector3::Zero();  ///< [m] delta_t

  [[nodiscard]] Real energy_j() const noexcept {
    return 0.5 * n_per_m * stretch_m.squaredNorm();
  }
  /// On the contact.
  [[nodiscard]] Vector3 force_n() const noexcept { return -n_per_m * stretch_m; }

  /// The contact moved. @param normal of the plane that it moved in.
  void follow(const Vector3& moved_m, const Vector3& normal) noexcept {
    if (n_per_m > 0.0) {
      stretch_m += moved_m - moved_m.dot(normal) * normal;
    }
  }
};

/// The spring at another place or normal force. None where the element has no friction.
/// @param place in an element. @param normal_n [N] less than 0 counts as 0.
void set_spring(FrictionSpring& spring, const FieldPlace& place,
                const ElementCache& cache, Real normal_n) noexcept;

}  // namespace palpate
