#include "runtime/fast/coupled_settle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "runtime/fast/relaxed_shift.h"

namespace palpate {
namespace {

// Two solutions of one equilibrium differ by no more than this share of U.
constexpr Real kSameEnergy = rounding(1e-14, 1e-6);

struct Friction {
  Real coefficient = 0.0;
  Real presliding_m = 0.0;
};

Friction friction_of(const FieldPlace& place, const ElementCache& cache) {
  Friction friction;
  const Element& element = cache.element[static_cast<std::size_t>(place.slot)];
  for (std::size_t a = 0; a < 3; ++a) {
    const Real weight =
        std::max(Real(0.0), place.frame.weight(static_cast<Eigen::Index>(a)));
    friction.coefficient += weight * element.node[a].friction;
    friction.presliding_m += weight * element.node[a].presliding_m;
  }
  return friction;
}

// The field at another delta_0.
ShiftedEnergy at_shift(const CoupledTick& t, Real shift_m) {
  t.model.field.shift_m = shift_m;
  (void)settle_contacts(t.model.field, t.set, t.surfaces);
  const CoupledContacts& c = t.model.field.equilibrium;
  return {shift_m, c.energy_j, c.force_n.head(t.count()).sum()};
}

// The spring of contact i for its force, turned into its tangent plane (23).
void set_spring(const CoupledTick& t, int i) {
  CoupledContact& contact = t.contact(i);
  const FieldPlace& place = t.at(i).place;
  if (place.slot < 0 || !contact.reading.loaded) {
    release(contact);
    return;
  }
  const Friction friction = friction_of(place, t.surfaces[i].cache);
  if (!(friction.coefficient > 0.0 && friction.presliding_m > 0.0)) {
    release(contact);
    return;
  }
  const Real normal_n = std::max(Real(0.0), t.model.field.equilibrium.force_n(i));
  const Real before = contact.friction_n_per_m;
  const Real now = friction.coefficient * normal_n / friction.presliding_m;
  contact.friction_n_per_m = now;
  Vector3& stretch = contact.presliding_m;
  const Real length2 = stretch.squaredNorm();
  if (!(length2 > 0.0)) {
    return;
  }
  stretch -= stretch.dot(place.frame.normal) * place.frame.normal;
  const Real in_plane2 = stretch.squaredNorm();
  const Real kept2 = now > before ? length2 * before / now : length2;
  const Real limit2 = friction.presliding_m * friction.presliding_m;
  if (in_plane2 > 0.0) {
    stretch *= std::sqrt(std::min(kept2, limit2) / in_plane2);
  }
}

// Brings the model down to the allowance: springs first, then delta_0.
void pay(const CoupledTick& t, Real allowed_j) {
  CoupledField& field = t.model.field;
  const Real springs = springs_j(t);
  const Real energy = field.equilibrium.energy_j;
  if (energy + springs <= allowed_j + kSameEnergy * energy) {
    return;
  }
  const Real kept_j = kPaid * std::max(Real(0.0), allowed_j - energy);
  const Real part = springs > 0.0 ? std::sqrt(kept_j / springs) : Real(0.0);
  for (int i = 0; i < t.count(); ++i) {
    t.contact(i).presliding_m *= part;
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
void recover(const CoupledTick& t, Real unspent_j, Real step_m) {
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

void release(CoupledContact& contact) noexcept {
  contact.friction_n_per_m = 0.0;
  contact.presliding_m.setZero();
}

Real springs_j(const CoupledTick& t) noexcept {
  Real sum = 0.0;
  for (int i = 0; i < t.count(); ++i) {
    const CoupledContact& contact = t.contact(i);
    sum += 0.5 * contact.friction_n_per_m * contact.presliding_m.squaredNorm();
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
  for (int i = 0; i < t.count(); ++i) {
    set_spring(t, i);
  }
  note_shortfall(ledger, field.equilibrium.energy_j + springs_j(t));
  const Real allowed = not_above(allowance_j(ledger));
  pay(t, allowed);
  if (field.shift_m > 0.0) {
    recover(t, allowed - field.equilibrium.energy_j - springs_j(t), recovery_m);
  }
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
