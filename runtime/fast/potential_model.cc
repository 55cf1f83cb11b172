#include "runtime/fast/potential_model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "runtime/account/rest_offset.h"
#include "runtime/memory/relaxation_step.h"
#include "runtime/memory/yield_step.h"

namespace palpate {
namespace {

// The surface as the tool's field sees it.
struct FieldView {
  const ElementCache& cache;
  const SurfaceMemory& memory;
  SurfaceMemory* kept;  // the same, where the tick may write it; null: it looks on
  Real radius_m;        // of the tool
};

FieldResponse respond(PotentialModel& model, const FieldView& view, Real shift_m) {
  return model.contact.remembers
             ? respond(model.place, view.cache, view.radius_m, shift_m, model.contact)
             : respond(model.place, view.cache, view.radius_m, shift_m, model.pieces);
}

FieldResponse respond(PotentialModel& model, const FieldView& view) {
  return respond(model, view, model.shift_m);
}

// At a new place of the model.
FieldResponse respond_at_new_place(PotentialModel& model, const FieldView& view) {
  read_memory(model.contact, view.memory, view.kept, model.place, view.cache,
              view.radius_m);
  return respond(model, view);
}

// What fixes the continuation of what was rendered at x_k.
struct Rendered {
  int slot = -1;
  Real height_m = 0.0;
  Vector3 weight;
  Vector3 normal;
  Vector3 rise;
  FieldResponse response;
  CarriedMemory memory;
};

Rendered rendered(const PotentialModel& model) {
  const FieldPlace& place = model.place;
  return {place.slot,
          place.height_m,
          place.weight,
          place.normal,
          place.rise,
          model.response,
          carried_memory(model.contact)};
}

// What was rendered until now, continued by this movement.
Real carried_j(const Rendered& at, const FieldView& view, Real shift_m,
               const Vector3& moved) {
  FieldPlace along;
  along.slot = at.slot;
  along.folded = true;
  along.height_m = at.height_m + at.rise.dot(moved);
  along.weight = at.weight;
  Real energy = 0.0;
  if (at.memory.bundles > 0) {
    RelaxingContact contact;
    enter(contact, view.memory, view.cache, at.slot, place_nodes(along, view.cache));
    continue_at(contact, at.memory);
    energy = respond(along, view.cache, view.radius_m, shift_m, contact).energy_j;
  } else {
    CurvePieces pieces;
    energy = respond(along, view.cache, view.radius_m, shift_m, pieces).energy_j;
  }
  const Vector3& f = at.response.force_n;
  const Vector3 along_n = f - f.dot(at.normal) * at.normal;
  return std::max(0.0, energy - along_n.dot(moved));
}

bool leapt(const FieldResponse& from, const FieldResponse& to, const Vector3& moved) {
  const Real force2 = std::max(from.force_n.squaredNorm(), to.force_n.squaredNorm());
  const Real most = kLeap * std::sqrt(force2 * moved.squaredNorm()) + kLeapJ;
  return !(std::abs(to.energy_j - from.energy_j) <= most);
}

// Energy at another place of the present element.
Real energy_within_j(PotentialModel& model, const FieldPlace& within,
                     const FieldView& view) {
  if (!model.contact.remembers) {
    return respond(within, view.cache, view.radius_m, model.shift_m, model.pieces)
        .energy_j;
  }
  RelaxingContact contact = model.contact;
  read_memory(contact, view.memory, nullptr, within, view.cache, view.radius_m);
  return contact.remembers
             ? respond(within, view.cache, view.radius_m, model.shift_m, contact)
                   .energy_j
             : Real(0.0);
}

// Moves the model to x. @return the energy of what was rendered until now, at x; the
// model's response is that of the field there, which may hold another energy.
Real move_field(PotentialModel& model, const FieldView& view, const Vector3& x) {
  FieldPlace& place = model.place;
  const Vector3 moved = x - model.tool_m;
  const Rendered before = rendered(model);
  const bool sound = !place.folded && !place.outside && !place.prism.flat;
  Real energy = -1.0;
  // Beyond its element the field goes on as that element's functions: what was
  // rendered, exactly.
  if (place.outside) {
    FieldPlace within = place;
    if (follow_within(within, x)) {
      energy = energy_within_j(model, within, view);
    }
  }
  follow(place, view.cache, x);
  model.response = respond_at_new_place(model, view);
  model.tool_m = x;
  // Sound before and after: one function of the place, unless its energy leaps to
  // another sheet. With memory the part of the force along the surface comes late, and
  // is made before it is judged.
  if (sound && !place.folded) {
    bool leaps = leapt(before.response, model.response, moved);
    if (leaps && model.contact.remembers) {
      model.response.force_n =
          whole_force_n(place, view.cache, model.contact, model.response);
      leaps = leapt(before.response, model.response, moved);
    }
    if (!leaps) {
      return model.response.energy_j;
    }
  }
  return energy >= 0.0 ? energy : carried_j(before, view, model.shift_m, moved);
}

// Another element where the rules allow it: in free space, or lost beyond an edge, the
// one the slow process last called active; else a newer copy of the same triangle.
// @returns whether the model changed.
bool change_field_element(PotentialModel& model, const FieldView& view, FieldKind field,
                          const Vector3& x) {
  const ElementCache& cache = view.cache;
  const bool news = cache.received != model.received_seen;
  model.received_seen = cache.received;
  if (!news && !model.place.outside) {
    return false;
  }
  const int active = cache.newest_active;
  const int here = model.place.slot;
  const bool another = active >= 0 && (here < 0 || triangle_in(cache, active) !=
                                                       triangle_in(cache, here));
  // Lost: beyond an edge, and the slow process has found the active element since.
  const bool lost =
      model.place.outside && active >= 0 &&
      cache.stored_at[static_cast<std::size_t>(active)] > model.received_inside;
  // Another element may have another potential here: only in free space, or where the
  // own one is lost.
  if (another && (here < 0 || !model.response.touching || lost)) {
    model.spring = {};
    model.tool_m = x;
    adopt(model.place, cache, active, x, field);
    model.received_inside = cache.received;
  } else if (here >= 0) {
    const int newer = find(cache, triangle_in(cache, here));
    if (newer == here) {
      return false;
    }
    move_to_copy(model.place, cache, newer);
  }
  if (model.place.slot >= 0) {
    model.response = respond_at_new_place(model, view);
  }
  return true;
}

// Brings the changed model down to the allowance: friction spring first, then delta_0.
void pay_field(PotentialModel& model, const FieldView& view, Real allowed_j) {
  const Real spring = model.spring.energy_j();
  if (model.response.energy_j + spring <= allowed_j) {
    return;
  }
  if (spring > 0.0) {
    const Real kept_j = kPaid * std::max(0.0, allowed_j - model.response.energy_j);
    model.spring.stretch_m *= std::sqrt(kept_j / spring);  // (23)
  }
  if (model.response.energy_j > allowed_j) {
    model.spring.stretch_m.setZero();
    const auto at_shift = [&](Real shift_m) {
      const FieldResponse at = respond(model, view, shift_m);
      return ShiftedEnergy{shift_m, at.energy_j, at.normal_n};
    };
    model.shift_m = raised_shift_m(
        {model.shift_m, model.response.energy_j, model.response.normal_n},
        unloading_shift_m(model.place, view.cache, view.radius_m), allowed_j, at_shift);
    model.response = respond(model, view);
  }
}

// delta_0 sinks back: at once where nothing is loaded, else as time and the unspent
// allowance permit.
void recover_field(PotentialModel& model, const FieldView& view, Real unspent_j,
                   Real step_m) {
  if (!model.response.loaded) {
    model.shift_m = std::min(model.shift_m,
                             unloading_shift_m(model.place, view.cache, view.radius_m));
    return;
  }
  const auto at_shift = [&](Real shift_m) {
    const FieldResponse at = respond(model, view, shift_m);
    return ShiftedEnergy{shift_m, at.energy_j, at.normal_n};
  };
  const Real shift = recovered_shift_m(
      {model.shift_m, model.response.energy_j, model.response.normal_n}, step_m,
      unspent_j, at_shift);
  if (shift != model.shift_m) {
    model.shift_m = shift;
    model.response = respond(model, view);
  }
}

// Spring and delta_0 for the present response, and what changed since the work was
// booked: paid, and booked.
void settle_field(PotentialModel& model, const FieldView& view, PassivityLedger& ledger,
                  Real recovered_m) {
  if (model.response.loaded) {
    set_spring(model.spring, model.place, view.cache,
               model.response.depth_m - model.shift_m, model.response.normal_n);
  } else {
    model.spring = {};
  }
  note_shortfall(ledger, model.response.energy_j + model.spring.energy_j());
  const Real allowed = not_above(allowance_j(ledger));
  pay_field(model, view, allowed);
  if (model.shift_m > 0.0) {
    const Real unspent = allowed - model.response.energy_j - model.spring.energy_j();
    recover_field(model, view, unspent, recovered_m);
  }
  Real keep = model.response.touching ? model.response.energy_j : 0.0;
  if (model.shift_m > 0.0 && model.response.touching) {
    keep = respond(model, view, 0.0).energy_j;
    if (model.contact.remembers) {
      (void)respond(model, view);  // the contact is where the tool is again
    }
  }
  book_change(ledger, model.response.energy_j + model.spring.energy_j(), keep);
}

// The contact has changed where it is: its response is the model's, but for the part of
// the force along the surface, which follows at the end of the tick.
void take_response(PotentialModel& model, const FieldView& view) {
  const Vector3 force_n = model.response.force_n;
  model.response =
      field_response(model.place, view.cache, view.radius_m, model.shift_m,
                     model.contact, response_of(model.contact, view.cache));
  model.response.force_n = force_n;
}

// Half a tick passes where the tool is.
void relax_field(PotentialModel& model, const FieldView& view, PassivityLedger& ledger,
                 Real half_s) {
  SurfaceMemory& memory = *view.kept;
  const Real time_s = pass_time(memory, half_s);
  if (!(time_s > 0.0)) {
    return;
  }
  if (!model.contact.remembers) {
    leave_alone(model.contact, memory, ledger, time_s);
    return;
  }
  const Real y = view.radius_m - model.place.height_m - model.shift_m;
  relax(model.contact, memory, ledger, view.cache, y, time_s);
  take_response(model, view);
}

// What the tool's depth asks of the surface to yield.
void yield_here(PotentialModel& model, const FieldView& view, PassivityLedger& ledger) {
  if (yield(model.contact, *view.kept, view.cache)) {
    take_response(model, view);
    book_yielding(ledger, model.response.energy_j + model.spring.energy_j());
  }
}

}  // namespace

Real moved_energy_j(PotentialModel model, const ElementCache& cache,
                    const SurfaceMemory& memory, Real tool_radius_m,
                    const Vector3& x_m) noexcept {
  if (model.place.slot < 0) {
    return 0.0;
  }
  model.spring.follow(x_m - model.tool_m, model.place.normal);
  return move_field(model, {cache, memory, nullptr, tool_radius_m}, x_m) +
         model.spring.energy_j();
}

void relax_before(PotentialModel& model, const ElementCache& cache,
                  SurfaceMemory& memory, PassivityLedger& ledger, Real tool_radius_m,
                  Real half_s) noexcept {
  relax_field(model, {cache, memory, &memory, tool_radius_m}, ledger, half_s);
}

void ask_at(PotentialModel& model, ElementCache& cache, SurfaceMemory& memory,
            Real tool_radius_m, const Vector3& x_m) noexcept {
  model.tool_m = x_m;
  if (model.place.slot < 0) {
    return;
  }
  const FieldView view{cache, memory, &memory, tool_radius_m};
  follow(model.place, cache, x_m);
  cache.pinned = model.place.slot;
  model.response = respond_at_new_place(model, view);
  if (model.contact.remembers) {
    model.response.force_n =
        whole_force_n(model.place, cache, model.contact, model.response);
  }
}

void book_image(PotentialModel& model, ElementCache& cache, SurfaceMemory& memory,
                PassivityLedger& ledger, const ElementModelLimits& limits) noexcept {
  const auto held_j =
      static_cast<double>(model.response.energy_j + model.spring.energy_j());
  if (held_j <= ledger.stored_j) {
    book_yielding(ledger, held_j);
  }
  settle_field(model, {cache, memory, &memory, limits.tool_radius_m}, ledger, 0.0);
}

Vector3 advance(PotentialModel& model, ElementCache& cache, SurfaceMemory& memory,
                PassivityLedger& ledger, const ElementModelLimits& limits,
                const Vector3& x_m, Real dt_s) noexcept {
  const FieldView view{cache, memory, &memory, limits.tool_radius_m};
  // 1. Work of the movement under the model of the last tick, (14) of the paper.
  Real moved_j = 0.0;
  if (model.place.slot >= 0) {
    model.spring.follow(x_m - model.tool_m, model.place.normal);
    moved_j = move_field(model, view, x_m);
    book_work(ledger, moved_j + model.spring.energy_j());
  }
  // 2. The newest element that is allowed; the cache keeps the one in use.
  const bool changed = change_field_element(model, view, limits.field, x_m);
  if (model.place.slot < 0) {
    return Vector3::Zero();
  }
  cache.pinned = model.place.slot;
  if (!model.place.outside) {
    model.received_inside = cache.received;
  }
  // 3. With memory the ledger balances both before time passes. Then half the tick's
  // time relaxes, and what the depth asks for yields.
  Real recovered_m = limits.recovery_m_per_s * dt_s;
  if (remembers(memory)) {
    if (changed || moved_j != model.response.energy_j) {
      settle_field(model, view, ledger, std::exchange(recovered_m, Real(0.0)));
    }
    relax_field(model, view, ledger, 0.5 * dt_s);
    yield_here(model, view, ledger);
  }
  // 4. Friction, delta_0 and the account for the response as it is now.
  settle_field(model, view, ledger, recovered_m);
  if (model.contact.remembers) {
    model.response.force_n =
        whole_force_n(model.place, cache, model.contact, model.response);
  }
  return model.response.force_n + model.spring.force_n();
}

}  // namespace palpate
