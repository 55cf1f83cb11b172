#include "runtime/contacts/coupled_settle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "runtime/account/rest_offset.h"

namespace palpate {
namespace {

// Two solutions of one equilibrium differ by no more than this share of U.
constexpr Real kSameEnergy = rounding(1e-14, 1e-6);

// The field at another delta_0.
ShiftedEnergy at_shift(const CoupledTick& t, Real shift_m) {
  t.model.field.shift_m = shift_m;
  (void)settle_contacts(t.model.field, t.set, t.surfaces);
  const CoupledContacts& c = t.model.field.equilibrium;
  return {shift_m, c.energy_j, c.force_n.head(t.count()).sum()};
}

// Brings the model down to the allowance: springs first, then delta_0.
void pay_contacts(const CoupledTick& t, Real allowed_j) {
  CoupledField& field = t.model.field;
  const Real springs = springs_j(t);
  const Real energy = field.equilibrium.energy_j;
  if (energy + springs <= allowed_j + kSameEnergy * energy) {
    return;
  }
  // A spring's energy goes by the square of its stretch: all stretches shrink by
  // sqrt(kept / springs).
  const Real kept_j = kPaid * std::max(Real(0.0), allowed_j - energy);
  const Real part = springs > 0.0 ? std::sqrt(kept_j / springs) : Real(0.0);
  for (int i = 0; i < t.count(); ++i) {
    t.contact(i).spring.stretch_m *= part;
  }
  if (energy > allowed_j) {
    const Real force_n = field.equilibrium.force_n.head(t.count()).sum();
    const Real shift =
        raised_shift_m({field.shift_m, energy, force_n},
                       unloading_shift_m(field, t.set), allowed_j, [&](Real shift_m) {
                         return at_shift(t, shift_m);
                       });
    if (!(at_shift(t, shift).energy_j <= allowed_j)) {  // C was scaled on the way
      (void)at_shift(t, unloading_shift_m(field, t.set));
    }
    read_contacts(t);
  }
}

// delta_0 sinks back, as in potential_model.cc.
void recover_contacts(const CoupledTick& t, Real unspent_j, Real step_m) {
  CoupledField& field = t.model.field;
  if (!t.model.loaded) {
    field.shift_m = std::min(field.shift_m, unloading_shift_m(field, t.set));
    return;
  }
  if (!(unspent_j > 0.0)) {
    return;
  }
  const CoupledContacts& c = field.equilibrium;
  const ShiftedEnergy now{field.shift_m, c.energy_j, c.force_n.head(t.count()).sum()};
  const Real shift = recovered_shift_m(now, step_m, unspent_j, [&](Real shift_m) {
    return at_shift(t, shift_m);
  });
  (void)at_shift(t, shift);
  read_contacts(t);
}

}  // namespace

Real springs_j(const CoupledTick& t) noexcept {
  Real sum = 0.0;
  for (int i = 0; i < t.count(); ++i) {
    sum += t.contact(i).spring.energy_j();
  }
  return sum;
}

void read_contacts(const CoupledTick& t) noexcept {
  t.model.touching = false;
  t.model.loaded = false;
  for (int i = 0; i < t.count(); ++i) {
    ContactReading& reading = t.contact(i).reading;
    reading = read_contact(t.model.field, t.set, t.surfaces, i);
    t.model.touching = t.model.touching || reading.touching;
    t.model.loaded = t.model.loaded || reading.loaded;
  }
}

void settle(const CoupledTick& t, PassivityLedger& ledger, Real recovery_m) noexcept {
  CoupledField& field = t.model.field;
  // 1. Springs take the normal force of this tick: k_t = mu f_i / delta_L.
  for (int i = 0; i < t.count(); ++i) {
    CoupledContact& contact = t.contact(i);
    if (contact.reading.loaded) {
      set_spring(contact.spring, t.at(i).place, t.surfaces[i].cache,
                 field.equilibrium.delta_m(i), field.equilibrium.force_n(i));
    } else {
      contact.spring = {};
    }
  }
  // 2. What is held beyond stored + tank is cut: springs first, then U by delta_0.
  note_shortfall(ledger, field.equilibrium.energy_j + springs_j(t));
  const Real allowed = not_above(allowance_j(ledger));
  pay_contacts(t, allowed);
  // 3. delta_0 sinks back by as much as is left.
  if (field.shift_m > 0.0) {
    recover_contacts(t, allowed - field.equilibrium.energy_j - springs_j(t),
                     recovery_m);
  }
  // 4. The tank keeps at most U at delta_0 = 0, and nothing in free space. delta_0
  // needs no more than that to sink back whole.
  Real keep = t.model.touching ? field.equilibrium.energy_j : Real(0.0);
  const Real left = allowed - field.equilibrium.energy_j - springs_j(t);
  if (field.shift_m > 0.0 && left > 0.0 && t.model.touching) {
    const Real shift = field.shift_m;
    keep = at_shift(t, 0.0).energy_j;
    (void)at_shift(t, shift);
    read_contacts(t);
  }
  book_change(ledger, field.equilibrium.energy_j + springs_j(t), keep);
  if (!t.model.touching && !t.model.loaded) {
    field.equilibrium.scale = 1.0;
  }
}

}  // namespace palpate
