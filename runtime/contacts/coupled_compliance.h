// C of the contacts of a field, and how it changes with their places (coupled_field.h).
#pragma once

#include <cstddef>

#include "runtime/account/real.h"
#include "runtime/contacts/coupled_field.h"
#include "runtime/contacts/coupled_set.h"

namespace palpate {

/// Whether two contacts keep their distance.
[[nodiscard]] inline bool of_one_port(const CoupledSet& set, std::size_t i,
                                      std::size_t j) noexcept {
  return set.sphere[i].port == set.sphere[j].port;
}

/// C for the places. Every contact has entered its element.
void couple_places(CoupledField& field, const CoupledSet& set,
                   CoupledSurfaces surfaces) noexcept;

/// sum_j dC_ij f_j by the coordinates of place i [m], C with its scale.
/// @param force_n f of all contacts.
[[nodiscard]] Vector3 sunk_slope_m(const CoupledField& field, const CoupledSet& set,
                                   CoupledSurfaces surfaces, std::size_t i,
                                   const ContactValues& force_n) noexcept;

}  // namespace palpate
