// What a changed coupled model owes the ledger: friction springs for the forces of the
// tick, then delta_0, paid and booked (coupled_model.h).
#pragma once

#include "runtime/account/passivity_ledger.h"
#include "runtime/account/real.h"
#include "runtime/contacts/coupled_field.h"
#include "runtime/contacts/coupled_model.h"
#include "runtime/contacts/coupled_set.h"

namespace palpate {

/// What the functions of a tick share.
struct CoupledTick {
  CoupledModel& model;
  CoupledField& scratch;
  const CoupledSet& set;
  CoupledSurfaces surfaces;

  [[nodiscard]] int count() const { return set.count; }
  [[nodiscard]] CoupledContact& contact(int i) const {
    return model.contact[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] CoupledPlace& at(int i) const {
    return model.field.at[static_cast<std::size_t>(i)];
  }
};

/// Energy of all springs [J].
[[nodiscard]] Real springs_j(const CoupledTick& t) noexcept;

/// Forces and flags of all contacts in the present equilibrium.
void read_contacts(const CoupledTick& t) noexcept;

/// Springs and delta_0 for the present places, and what changed since the work was
/// booked: paid, and booked. @param recovery_m [m] >= 0, most that delta_0 sinks back.
void settle(const CoupledTick& t, PassivityLedger& ledger, Real recovery_m) noexcept;

}  // namespace palpate
