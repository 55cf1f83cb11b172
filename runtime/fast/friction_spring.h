// Coulomb friction of a contact on the potential field, as a spring in its tangent
// plane.
//
// The spring holds delta_t . K delta_t / 2, delta_t the movement of the contact in the
// plane since it stuck. It slips where its force K delta_t would pass mu F_n.
//
// Where the nodes know a presliding length delta_L, K is k_t = mu F_n / delta_L times
// the identity. Where they know the body's lateral stiffness S (contact_table.h),
//
//   K = F_n / d sum_j w_j S_j,   d = sum_j w_j d_j,
//
// d_j the depth past the touch of node j. A slip then is the closest point projection,
//
//   delta_t' = (1 + s / (mu F_n) K)^-1 delta_t,   s >= 0 with |K delta_t'| = mu F_n.
//
// So the force settles against the slip, and the spring's energy falls (convex
// potential; Simo and Hughes 1998, section 3.6).
//
// The spring turns with the plane and keeps its length. Where the spring would hold
// more after a change of K, the anchor follows so that it holds as much as before (23).
// Where it holds less, the difference is lost. So a change of K never creates energy.
#pragma once

#include "runtime/account/real.h"
#include "runtime/element/element_cache.h"
#include "runtime/element/prism_walk.h"

namespace palpate {

struct FrictionSpring {
  Real n_per_m = 0.0;                        ///< [N/m] >= 0 k_t, or the mean of K
  Vector3 stretch_m = Vector3::Zero();       ///< [m] delta_t
  bool by_body = false;                      ///< K counts, else k_t
  Matrix3 tensor_n_per_m = Matrix3::Zero();  ///< [N/m] K, in the plane

  /// On the contact.
  [[nodiscard]] Vector3 force_n() const noexcept {
    return by_body ? Vector3(-(tensor_n_per_m * stretch_m))
                   : Vector3(-n_per_m * stretch_m);
  }
  [[nodiscard]] Real energy_j() const noexcept {
    return by_body ? Real(-0.5) * stretch_m.dot(force_n())
                   : Real(0.5) * n_per_m * stretch_m.squaredNorm();
  }

  /// The contact moved. @param normal of the plane that it moved in.
  void follow(const Vector3& moved_m, const Vector3& normal) noexcept {
    if (n_per_m > 0.0) {
      stretch_m += moved_m - moved_m.dot(normal) * normal;
    }
  }
};

/// The spring at another place, depth or normal force. None where the element has no
/// friction.
/// @param place in an element. @param depth_m [m] of the tool, less delta_0.
/// @param normal_n [N] less than 0 counts as 0.
void set_spring(FrictionSpring& spring, const FieldPlace& place,
                const ElementCache& cache, Real depth_m, Real normal_n) noexcept;

}  // namespace palpate
