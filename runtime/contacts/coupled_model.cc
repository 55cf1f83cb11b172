#include "runtime/contacts/coupled_model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Geometry>

#include "runtime/contacts/coupled_relaxation.h"
#include "runtime/contacts/coupled_settle.h"
#include "runtime/contacts/coupled_yielding.h"
#include "runtime/fast/potential_field.h"

namespace palpate {
namespace {

// One contact in the move of a tick.
struct Moved {
  Vector3 moved_m;
  Vector3 force_n;  // at x_k
  Vector3 along_n;  // of it along the surface, where that continues it
  bool sound;       // else scratch has the place where its rendering goes on
};
using Moves = std::array<Moved, kContactsMax>;

// The field at the present places. False: it is another one, C is scaled.
bool settle_places(const CoupledTick& t, Keep keep) {
  set_places(t.model.field, t.set, t.surfaces, keep);
  const bool same = settle_contacts(t.model.field, t.set, t.surfaces);
  read_contacts(t);
  return same;
}

// What of a place fixes its tangent plane.
struct Tangent {
  int slot;
  Vector3 position_m;
  Real height_m;
  Vector3 weight;
  Vector3 normal;
  Vector3 rise;
};

// What was rendered at x_k, continued in its tangent plane.
void continue_in(const Tangent& tangent, const CoupledSurface& surface,
                 const Vector3& moved, FieldPlace& place) {
  place.slot = tangent.slot;
  place.prism =
      make_prism(surface.cache.element[static_cast<std::size_t>(tangent.slot)]);
  place.folded = true;
  place.outside = false;
  place.position_m = tangent.position_m + moved;
  place.height_m = tangent.height_m + tangent.rise.dot(moved);
  place.weight = tangent.weight;
  place.normal = tangent.normal;
  place.rise = tangent.rise;
  place.turn.setZero();
}

// Moves contact i to x, and its spring. Where its place is not sound, scratch gets the
// one where its rendering goes on.
void move_contact(const CoupledTick& t, int i, const Vector3& x, Moved& move) {
  // 1. The friction spring follows in the tangent plane of the last tick. 2. A place
  // beyond its element goes on there in scratch. 3. The place itself follows through
  // the neighbours. 4. A place that is not sound by 2 or 3 goes on in the tangent plane
  // of the last tick.
  FieldPlace& place = t.at(i).place;
  CoupledContact& contact = t.contact(i);
  move.moved_m = x - contact.centre_m;
  move.force_n = contact.reading.force_n;
  move.along_n.setZero();
  move.sound = true;
  contact.centre_m = x;
  if (place.slot < 0) {
    return;
  }
  const Tangent before{place.slot,   place.position_m, place.height_m,
                       place.weight, place.normal,     place.rise};
  contact.spring.follow(move.moved_m, before.normal);
  const bool sound = !place.folded && !place.outside && !place.prism.flat;
  FieldPlace& on = t.scratch.at[static_cast<std::size_t>(i)].place;
  bool within = false;
  if (place.outside) {
    on = place;
    within = follow_within(on, x);
  }
  follow(place, t.surfaces[i].cache, x);
  move.sound = sound && !place.folded;
  if (move.sound || within) {
    return;
  }
  // F_t = F - (F . n) n of the last tick: along the surface the rendered energy goes on
  // as -F_t . (x - x_k).
  move.along_n = move.force_n - move.force_n.dot(before.normal) * before.normal;
  continue_in(before, t.surfaces[i], move.moved_m, on);
}

// Energy with every contact that is not sound continued.
Real continued_j(const CoupledTick& t, const Moves& moves, Real scale) {
  CoupledField& field = t.scratch;
  field.shift_m = t.model.field.shift_m;
  field.equilibrium.scale = scale;
  field.equilibrium.dimple_m = t.model.field.equilibrium.dimple_m;
  field.equilibrium.factor.sound = false;
  Real along_j = 0.0;
  for (int i = 0; i < t.count(); ++i) {
    const auto self = static_cast<std::size_t>(i);
    CoupledPlace& at = field.at[self];
    if (moves[self].sound) {
      at.place = t.at(i).place;
    }
    at.slot = -1;  // another element may be in the slot by now
    at.stored_at = 0;
    enter(field, t.set, t.surfaces, i);
    if (remembers(t.surfaces[i].memory)) {
      field.memory[self] = t.model.field.memory[self];
    }
    along_j += moves[self].along_n.dot(moves[self].moved_m);
  }
  set_places(field, t.set, t.surfaces, Keep::kNo);
  return settle_contacts(field, t.set, t.surfaces)
             ? std::max(Real(0.0), field.equilibrium.energy_j - along_j)
             : Real(-1.0);
}

Real linear_j(Real energy_before, Real given_j) {
  return std::max(Real(0.0), energy_before - given_j);
}

// Moves all contacts. @returns the energy of what was rendered until now, there; the
// model's field is that of the new places, which may hold another energy.
Real move_contacts(const CoupledTick& t, const PortPoses& pose, Keep keep) {
  CoupledModel& model = t.model;
  const Real energy_before = model.field.equilibrium.energy_j;
  const Real scale = model.field.equilibrium.scale;
  Moves moves;
  bool sound = true;
  Real given_j = 0.0;  // by the forces of x_k on the way
  for (int i = 0; i < t.count(); ++i) {
    const auto self = static_cast<std::size_t>(i);
    move_contact(t, i, centre_of(t.set, pose, i), moves[self]);
    enter(model.field, t.set, t.surfaces, i);
    sound = sound && moves[self].sound;
    given_j += moves[self].force_n.dot(moves[self].moved_m);
  }
  if (!settle_places(t, keep)) {
    return linear_j(energy_before, given_j);
  }
  const Real energy =
      sound ? model.field.equilibrium.energy_j : continued_j(t, moves, scale);
  Real most = kLeapJ;
  for (int i = 0; i < t.count(); ++i) {
    const auto self = static_cast<std::size_t>(i);
    const Vector3& now = t.contact(i).reading.force_n;
    const Real force2 = std::max(moves[self].force_n.squaredNorm(), now.squaredNorm());
    most += kLeap * std::sqrt(force2 * moves[self].moved_m.squaredNorm());
  }
  return energy >= 0.0 && std::abs(energy - energy_before) <= most
             ? energy
             : linear_j(energy_before, given_j);
}

// Another element for contact i where the rules of potential_model.cc allow it.
// @returns whether its place changed.
bool change_contact_element(const CoupledTick& t, int i) {
  CoupledContact& contact = t.contact(i);
  FieldPlace& place = t.at(i).place;
  const ElementCache& cache = t.surfaces[i].cache;
  // Nothing can change without a new message, unless the contact has lost its element.
  const bool news = cache.received != contact.received_seen;
  contact.received_seen = cache.received;
  if (!news && !place.outside) {
    return false;
  }
  const int active = cache.newest_active;
  const int here = place.slot;
  const bool another = active >= 0 && (here < 0 || triangle_in(cache, active) !=
                                                       triangle_in(cache, here));
  // Lost: beyond an edge, and the slow process has found the active element since.
  const bool lost =
      place.outside && active >= 0 &&
      cache.stored_at[static_cast<std::size_t>(active)] > contact.received_inside;
  // Another element may have another potential here. A contact that touches therefore
  // keeps its element, unless the contact is lost.
  if (another && (here < 0 || !contact.reading.touching || lost)) {
    contact.spring = {};
    adopt(place, cache, active, contact.centre_m, t.set.field);
    contact.received_inside = cache.received;
    return true;
  }
  if (here < 0) {
    return false;
  }
  // The same triangle with newer responses changes the energy here, which the ledger
  // books.
  const int newer = find(cache, triangle_in(cache, here));
  const bool copied = newer >= 0 && newer != here;
  if (copied) {
    move_to_copy(place, cache, newer);
  }
  return copied;
}

bool change_elements(const CoupledTick& t) {
  bool changed = false;
  for (int i = 0; i < t.count(); ++i) {
    changed = change_contact_element(t, i) || changed;
    enter(t.model.field, t.set, t.surfaces, i);
    ElementCache& cache = t.surfaces[i].cache;
    cache.pinned = t.at(i).place.slot;
    if (!t.at(i).place.outside) {
      t.contact(i).received_inside = cache.received;
    }
  }
  return changed;
}

// An equilibrium as the start of another, whose places will give C: without what lies
// beyond its contacts, for all of it is 70 kB.
void start_from(const CoupledContacts& from, CoupledContacts& to) {
  to.count = from.count;
  to.depth_m = from.depth_m;
  to.scale = from.scale;
  to.dimple_m = from.dimple_m;
  to.delta_m = from.delta_m;
  to.force_n = from.force_n;
  to.stiffness_n_per_m = from.stiffness_n_per_m;
  to.own_energy_j = from.own_energy_j;
  to.energy_j = from.energy_j;
  to.solved = from.solved;
  to.solved_depth_m = from.solved_depth_m;
  const Eigen::Index n = from.factor.count;
  to.factor.count = from.factor.count;
  to.factor.sound = from.factor.sound;
  to.factor.contact = from.factor.contact;
  to.factor.root = from.factor.root;
  to.factor.lower.topLeftCorner(n, n) = from.factor.lower.topLeftCorner(n, n);
  to.factor.inverse = from.factor.inverse;
}

}  // namespace

PortWrenches wrenches(const CoupledModel& model, const CoupledSet& set,
                      const PortPoses& pose) noexcept {
  PortWrenches sum;
  for (std::size_t i = 0; i < static_cast<std::size_t>(set.count); ++i) {
    const CoupledContact& contact = model.contact[i];
    const auto port = static_cast<std::size_t>(set.sphere[i].port);
    const Vector3 f = contact.reading.force_n + contact.spring.force_n();
    sum[port].force_n += f;
    sum[port].torque_n_m += (contact.centre_m - pose[port].position_m).cross(f);
  }
  return sum;
}

void relax_before(CoupledModel& model, CoupledField& scratch, const CoupledSet& set,
                  CoupledSurfaces surfaces, PassivityLedger& ledger,
                  Real half_s) noexcept {
  relax_here({model, scratch, set, surfaces}, ledger, half_s);
}

PortWrenches advance(CoupledModel& model, CoupledField& scratch, const CoupledSet& set,
                     CoupledSurfaces surfaces, PassivityLedger& ledger,
                     const PortPoses& pose, Real recovery_m_per_s, Real dt_s) noexcept {
  const CoupledTick t{model, scratch, set, surfaces};
  // 1. Work of the movement under the model of the last tick, (14) of the paper.
  const Real moved_j = move_contacts(t, pose, Keep::kYes);
  book_work(ledger, moved_j + springs_j(t));
  // 2. The newest elements that are allowed.
  const bool changed = change_elements(t);
  if (changed) {
    (void)settle_places(t, Keep::kYes);
  }
  // 3. With memory the ledger balances both before time passes, for it is the dent that
  // pays for relaxing.
  Real recovery_m = recovery_m_per_s * dt_s;
  if (model.field.remembers &&
      (changed || moved_j != model.field.equilibrium.energy_j)) {
    settle(t, ledger, std::exchange(recovery_m, Real(0.0)));
  }
  // 4. The second half of the tick's time, then what yields. 5. The rest is balanced.
  relax_here(t, ledger, Real(0.5) * dt_s);
  yield_here(t, ledger);
  settle(t, ledger, recovery_m);
  return wrenches(model, set, pose);
}

void carry(CoupledModel& model, CoupledField& scratch, const CoupledSet& set,
           CoupledSurfaces surfaces, PassivityLedger& ledger,
           const PortPoses& pose) noexcept {
  const CoupledTick t{model, scratch, set, surfaces};
  (void)move_contacts(t, pose, Keep::kYes);
  settle(t, ledger, 0.0);
}

Real moved_energy_j(const CoupledModel& model, CoupledModel& moved,
                    CoupledField& scratch, const CoupledSet& set,
                    CoupledSurfaces surfaces, const PortPoses& pose) noexcept {
  for (std::size_t i = 0; i < static_cast<std::size_t>(set.count); ++i) {
    moved.field.at[i] = model.field.at[i];
    moved.contact[i] = model.contact[i];
    if (remembers(surfaces[i].memory)) {
      moved.field.memory[i] = model.field.memory[i];
    }
  }
  start_from(model.field.equilibrium, moved.field.equilibrium);
  moved.field.shift_m = model.field.shift_m;
  const CoupledTick t{moved, scratch, set, surfaces};
  return move_contacts(t, pose, Keep::kNo) + springs_j(t);
}

}  // namespace palpate
