// The potential field of a body that several contacts press: one function of the
// contacts' places.
//
// Contact i is at x_i, and d_i is its normal penetration less delta_0. The stored curve
// at its place is E_i(y) = sum_a n_a E_a(c_a (y - t_a)) (potential_field.h). The energy
// is U of coupled_contacts.h and
//
//   -F_i = dU/dx_i = dE_i/dx_i at delta_i - f_i sum_j (dC_ij/dx_i) f_j - f_i n_out.
//
// No derivative of delta is needed, because U is stationary in f. C_ij changes with x_i
// by the weights of the nodes' rows. Between two ports C_ij changes also by the
// distance of the places on the surface at rest.
//
// A surface may remember (relaxing_contact.h). The whole body's conjugate is
// U*(f) = sum E_i*(f_i) + f.C f / 2. The contacts' places have relaxed forces s, and
// the contacts bear phi >= 0. The rendered potential is the Bregman distance from the
// dents,
//
//   u(d) = max over phi >= 0 of [ phi.d - U*(s + phi) + U*(s) ]
//        = max over phi >= 0 of [ phi.(d - C s) - sum e_i*(phi_i) - phi.C phi / 2 ],
//
// with e_i*(phi) = E_i*(s_i + phi) - E_i*(s_i). The equations are the same, with the
// response max(0, p_i - s_i) of one contact's memory for its curve. The dents of all
// contacts are taken from the depths. Dents sink the others as forces do: they are
// stress that the body still bears. With p = s + phi,
//
//   du/dx_i = de_i/dx_i at delta_i - phi_i n_out
//             - p_i sum_j (dC_ij/dx_i) p_j + s_i sum_j (dC_ij/dx_i) s_j
//             - (C phi)_i ds_i/dx_i.
//
// So a contact that is lifted, but still over its dent, feels a force along the surface
// while others press. The force comes from how much less that dent sinks the others
// where the contact goes.
//
// Each contact has a memory of its own, and finds its own dents alone. Contacts lie as
// far apart as sites do. In one table a site would count the force of two contacts
// twice: as one contact's own stress, and as the sinking by the other. Both contacts
// would relax it. What has yielded (yielding_place.h) is shape, not stress: contacts
// with the same responses share it, and find each other's dents. E_i is then that of
// the elastic response.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/contacts/coupled_contacts.h"
#include "runtime/contacts/coupled_set.h"
#include "runtime/element/cubic_cache.h"
#include "runtime/element/element_cache.h"
#include "runtime/element/prism_walk.h"
#include "runtime/memory/relaxing_contact.h"
#include "runtime/memory/surface_memory.h"

namespace palpate {

/// An element for one contact, with the rows of its nodes.
struct ContactElement {
  std::int32_t contact = 0;  ///< [0, count)
  Element element;
  std::array<ContactRow, 3> row{};
};

/// What the slow process has sent for one contact, and what the surface remembers of
/// it. About 400 kB.
struct CoupledSurface {
  ElementCache cache;
  SurfaceMemory memory;
  std::array<std::array<ContactRow, 3>, kCacheSlots> row{};
};

/// Stores a copy, as store() of element_cache.h. @returns whether it was stored: not an
/// element with a row that is not finite.
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
  bool remembers = false;  ///< some contact's surface does; else the rest is not used
  ContactValues carried_n = ContactValues::Zero();  ///< [N] s
  std::array<RelaxingContact, kContactsMax> memory;
};

/// Reads what is fixed for the element that contact i is in, if that is another one.
void enter(CoupledField& field, const CoupledSet& set, CoupledSurfaces surfaces,
           int i) noexcept;

/// Whether what was at hand of the surfaces' memories goes back to them where another
/// element comes to hand.
enum class Keep : bool { kNo, kYes };

/// Depths, C and relaxed forces for the places. Every contact has entered its element.
void set_places(CoupledField& field, const CoupledSet& set, CoupledSurfaces surfaces,
                Keep keep) noexcept;

/// Takes s of all places, and C s, after they have changed.
void take_relaxed(CoupledField& field, const CoupledSet& set) noexcept;

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
