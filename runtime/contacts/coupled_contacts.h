// Contacts that share a body: each one's force sinks the surface under the others.
//
// Contact i has the stored curve f_i, energy E_i, and is d_i deep. C_ij (i != j,
// symmetric) is how far 1 N at j moves the surface at i, along the inward normals of
// both contacts. The curves hold C_ii already, nonlinear. With delta_i the depth that
// is left,
//
//   delta_i + sum_j C_ij f_j(delta_j) = d_i
//   U(d) = sum E_i(delta_i) + 1/2 sum_ij C_ij f_i f_j
//        = max over f >= 0 of [ f.d - sum E_i*(f_i) - f.C f / 2 ],     dU/dd_i = f_i
//
// E* the conjugate of E. One contact alone has delta = d. The solution is unique where
// diag(1/k) + C is positive definite, k_i = f_i'(delta_i). That matrix is the
// compliance of flat punches on one body. The matrix is positive definite where the
// punches do not overlap (two on a half-space: more than 2 a / pi apart).
//
// The equations are solved for delta, because a curve's inverse has an infinite slope
// where the curve is touched. With g = delta + C f - d, D = diag(sqrt(k)) and
// S = 1 + D C D,
//
//   y = -D S^-1 D g,     change of delta = -g - C y,
//
// Newton's method, which holds for contacts without slope (lifted off, or at the end of
// a curve) as they are. S is factored where the old factor does not do any more. A
// curve that falls counts as level in S.
//
// Where the surface remembers (coupled_field.h), f_i is what contact i bears now. There
// d_i is less by what relaxed forces s sink the surface: d - C s stands for d.
//
// Where the method does not end, or S at the solution is not positive definite, C is
// halved for good and `scaled` says so. The scaled C has another energy, which the
// caller has to book as a change. C = 0 always ends.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "runtime/account/real.h"

namespace palpate {

constexpr int kContactsMax = 64;

using ContactValues = Eigen::Array<Real, kContactsMax, 1>;
using ContactMatrix = Eigen::Matrix<Real, kContactsMax, kContactsMax>;

/// S = L L^T of the contacts that had a slope, and that slope.
struct CoupledFactor {
  int count = 0;  ///< of them; 0: none yet
  bool sound = false;
  std::array<std::int8_t, kContactsMax> contact{};
  ContactValues root = ContactValues::Zero();  ///< sqrt(k) [(N/m)^(1/2)]
  ContactMatrix lower = ContactMatrix::Zero();
  ContactValues inverse = ContactValues::Zero();  ///< of the diagonal of L
};

/// What is asked and what is found; the last solution is where the next solve begins.
/// About 70 kB.
struct CoupledContacts {
  int count = 0;                                  ///< [0, kContactsMax]
  ContactValues depth_m = ContactValues::Zero();  ///< [m] d_i
  ContactValues sunk_m = ContactValues::Zero();   ///< [m] sum_j C_ij s_j before `scale`
  /// [m/N] C_ij, symmetric, 0 on the diagonal; before `scale`.
  ContactMatrix compliance_m_per_n = ContactMatrix::Zero();
  Real scale = 1.0;  ///< [-] [0, 1] of C

  ContactValues dimple_m = ContactValues::Zero();  ///< [m] sum_j C_ij f_j
  ContactValues delta_m = ContactValues::Zero();   ///< [m] delta_i
  ContactValues force_n = ContactValues::Zero();   ///< [N] f_i
  ContactValues stiffness_n_per_m = ContactValues::Zero();
  ContactValues own_energy_j = ContactValues::Zero();  ///< [J] E_i(delta_i)
  Real energy_j = 0.0;                                 ///< [J] U
  int evaluations = 0;  ///< of the curves, in the latest solve
  int factorings = 0;   ///< in the latest solve
  CoupledFactor factor;
  int solved = 0;  ///< count of the last solution; 0: there is none to begin at
  ContactValues solved_depth_m = ContactValues::Zero();  ///< [m] d - C s of it
};

/// The stored curves: fills force_n and stiffness_n_per_m of every contact for its
/// delta_m, or, asked for `energy`, own_energy_j. Does not throw.
struct ContactCurves {
  void* of = nullptr;
  void (*evaluate)(void* of, CoupledContacts& contacts, bool energy) = nullptr;
};

/// Finds the equilibrium for depth_m, compliance_m_per_n and scale, to 1e-12 m (float:
/// 2e-8 m): bounded work, at most kCoupledEvaluationsMax evaluations for each of nine
/// scales. U is exact to second order in what is left of g. With a depth that is not
/// finite U is not, and `scale` stays.
/// @returns whether it was found for the scale that was asked; else `scale` is smaller
/// now.
bool solve(CoupledContacts& contacts, const ContactCurves& curves) noexcept;

constexpr int kCoupledEvaluationsMax = 60;

/// factor C v of the contacts, in the first `count` of `out`.
void apply_compliance(const CoupledContacts& contacts, Real factor,
                      const ContactValues& v, ContactValues& out) noexcept;

/// Stiffness of a contact on this body [N/m]: df_i/dd_i with the other contacts held
/// where they are. A single contact would have this slope as its stiffness.
/// @param i in [0, count).
[[nodiscard]] Real coupled_stiffness_n_per_m(const CoupledContacts& contacts, int i,
                                             CoupledFactor& scratch) noexcept;

}  // namespace palpate
