// The potential field of a body that several contacts press: one function of the
// contacts' places.
//
// With contact i at x_i, d_i its normal penetration less delta_0, and the stored curve
// at its place E_i(y) = sum_a n_a E_a(c_a (y - t_a)) (potential_field.h), the energy is
// U of coupled_contacts.h and
//
//   -F_i = dU/dx_i = dE_i/dx_i at delta_i - f_i sum_j (dC_ij/dx_i) f_j - f_i n_out.
//
// No derivative of delta is needed, because U is stationary in f. C_ij changes with x_i
// by the weights of the nodes' rows; between two ports also by the distance of the
// places on the surface at rest.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "runtime/fast/coupled_contacts.h"
#include "runtime/fast/coupled_set.h"
#include "runtime/fast/cubic_cache.h"
#include "runtime/fast/element_cache.h"
#include "runtime/fast/prism_walk.h"
#include "runtime/fast/real.h"

namespace palpate {

/// An element for one contact, with the rows of its nodes.
struct ContactElement {
  std::int32_t contact = 0;  ///< [0, count)
  Element element;
  std::array<ContactRow, 3> row{};
};

/// What the slow process has sent for one contact. About 200 kB.
struct CoupledSurface {
  ElementCache cache;
  std::array<std::array<ContactRow, 3>, kCacheSlots> row{};
};

/// Stores a copy, as store() of element_cache.h. @returns whether it was stored: not an
/// element that remembers or yields (`memory.terms`, `memory.yields`), which several
/// contacts cannot render, nor one with a row that is not finite.
bool store(CoupledSurface& surface, const ContactElement& message) noexcept;

/// One contact's place, and what of its element is read there.
struct CoupledPlace {
  FieldPlace place;
  CurvePieces pieces;
  int slot = -1;                ///< that the rest is of; -1: none
  std::uint64_t stored_at = 0;  ///< which element that was
  std::array<Real, 3> lean{};   ///< [-] c_a; 0 without response
  std::array<Real, 3> touch_m{};
  /// [m/N] c_a(r_ij) of its node a (column) at contact j (row).
  Eigen::Matrix<Real, kContactsMax, 3> reach;
  /// [m^1/2 N^-1/2] s_m b_m of its nodes (columns).
  Eigen::Matrix<Real, kMostModes, 3> signed_mode;
};

using CoupledPlaces = std::array<CoupledPlace, kContactsMax>;

/// The surfaces of a set's contacts, in their order.
using CoupledSurfaces = CoupledSurface*;

/// What the energy is a function of, besides what the slow process has sent.
struct CoupledField {
  CoupledPlaces at;
  CoupledContacts equilibrium;
  Real shift_m = 0.0;  ///< [m] delta_0 >= 0 of all contacts
  /// b of the contacts (rows) at their places.
  Eigen::Matrix<Real, kContactsMax, kMostModes> mode;
};

/// Reads what is fixed for the element that contact i is in, if that is another one.
void enter(CoupledField& field, const CoupledSet& set, CoupledSurfaces surfaces,
           int i) noexcept;

/// Depths and C for the places. Every contact has entered its element.
void set_places(CoupledField& field, const CoupledSet& set,
                CoupledSurfaces surfaces) noexcept;

/// Finds the equilibrium for the present delta_0. @returns as solve().
bool settle_contacts(CoupledField& field, const CoupledSet& set,
                     CoupledSurfaces surfaces) noexcept;

/// What a contact is doing in the equilibrium.
struct ContactReading {
  bool touching = false;      ///< some node without delta_0, were it not for the others
  bool loaded = false;        ///< f_i > 0, or at the end of that
  bool extrapolated = false;  ///< beyond a curve
  Vector3 force_n = Vector3::Zero();  ///< F_i, on the tool
};

/// F_i and flags of contact i.
[[nodiscard]] ContactReading read_contact(CoupledField& field, const CoupledSet& set,
                                          CoupledSurfaces surfaces, int i) noexcept;

/// Largest delta_0 at which something is loaded, of all contacts.
[[nodiscard]] Real unloading_shift_m(const CoupledField& field,
                                     const CoupledSet& set) noexcept;

}  // namespace palpate
