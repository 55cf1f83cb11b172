#include "runtime/fast/element_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/account/rest_offset.h"
#include "runtime/fast/element_walk.h"
#include "runtime/memory/relaxation_step.h"
#include "runtime/memory/yield_step.h"

namespace palpate {
namespace {

bool has_friction(const ElementModel& model) {
  return model.friction > 0.0 && model.presliding_m > 0.0;
}

void release(ElementModel& model) {
  model.friction_n_per_m = 0.0;
  model.slip_m.setZero();
}

// At another contact point than before.
ElementResponse respond_anew(ElementModel& model, const ElementCache& cache,
                             SurfaceMemory& memory, const Vector3& x) {
  read_memory(model, memory, &memory, cache);
  return respond_here(model, cache, x);
}

// Another element where the rules allow it: in free space, or lost beyond an edge, the
// one the slow process last called active; else a newer copy of the same triangle.
// True if the model changed.
bool change_element(ElementModel& model, const ElementCache& cache,
                    const ElementResponse& old, const Vector3& x, Real radius) {
  const bool news = cache.received != model.received_seen;
  model.received_seen = cache.received;
  const int active = cache.newest_active;
  // Lost: beyond an edge, and the slow process has called another element active since.
  const bool lost =
      model.outside && active >= 0 &&
      triangle_in(cache, active) != triangle_in(cache, model.slot) &&
      cache.stored_at[static_cast<std::size_t>(active)] > model.received_inside;
  const bool free = model.slot < 0 || (news && !old.touching);
  if (active >= 0 && (free || lost)) {
    release(model);
    adopt(model, cache, active, x, radius);
    model.received_inside = cache.received;
    return true;
  }
  // A newer copy of the same triangle may hold other responses; the contact point
  // stays.
  if (news && model.slot >= 0) {
    const int newer = find(cache, triangle_in(cache, model.slot));
    if (newer != model.slot) {
      place(model, cache, newer, model.area, radius);
      return true;
    }
  }
  return false;
}

// The contact point follows the tool: at once where nothing holds it, else so far that
// the presliding displacement is delta_L again. True if it moved.
bool slide(ElementModel& model, const ElementCache& cache, const ElementResponse& old,
           const Vector3& x, Real radius) {
  if (!old.loaded || !has_friction(model)) {
    release(model);
    follow(model, cache, x, Vector3::Zero(), radius);
    return true;
  }
  const Real stretch = old.presliding_m.norm();
  if (stretch <= model.presliding_m) {
    return false;
  }
  model.slip_m.setZero();
  follow(model, cache, x, old.presliding_m * (model.presliding_m / stretch), radius);
  return true;
}

// Normal energy and force as functions of delta_0.
auto energy_by_shift(ElementModel& model, const ElementCache& cache, const Vector3& x) {
  return [&](Real shift_m) {
    model.shift_m = shift_m;
    const ElementResponse at = respond_here(model, cache, x);
    return ShiftedEnergy{shift_m, at.normal_j, at.normal_n};
  };
}

// Raises delta_0 until the normal energy is what is allowed.
ElementResponse raise_shift(ElementModel& model, const ElementCache& cache,
                            const Vector3& x, const ElementResponse& response,
                            Real allowed_j) {
  const Real unloaded = response.depth_m - std::min({model.touch_m[0], model.touch_m[1],
                                                     model.touch_m[2]});
  model.shift_m = raised_shift_m({model.shift_m, response.normal_j, response.normal_n},
                                 unloaded, allowed_j, energy_by_shift(model, cache, x));
  return respond_here(model, cache, x);
}

// Brings the changed model down to the allowance: friction spring first, then delta_0.
void pay(ElementModel& model, const ElementCache& cache, const Vector3& x,
         Real allowed_j, ElementResponse& response) {
  if (response.potential_j() <= allowed_j) {
    return;
  }
  const Real spring_j = kPaid * std::max(0.0, allowed_j - response.normal_j);
  if (response.friction_j > 0.0) {
    const Real kept = std::sqrt(spring_j / response.friction_j);  // (23)
    model.slip_m += (1.0 - kept) * response.presliding_m;
    response.presliding_m *= kept;
    response.friction_j = spring_j;
  }
  if (response.normal_j > allowed_j) {
    response = raise_shift(model, cache, x, response, allowed_j);
    response.friction_j = 0.0;
    response.presliding_m.setZero();
  }
}

// Bleeds delta_0 back by as much as time and the unspent allowance permit.
void recover_loaded(ElementModel& model, const ElementCache& cache, const Vector3& x,
                    Real unspent_j, Real shift_max_m, ElementResponse& response) {
  const Real shift = model.shift_m;
  Real back = std::min(shift, shift_max_m);
  for (int attempt = 0; attempt < 2 && back > 0.0; ++attempt) {
    model.shift_m = shift - back;
    const ElementResponse changed = respond_here(model, cache, x);
    const Real cost = changed.potential_j() - response.potential_j();
    if (cost <= unspent_j) {
      response = changed;
      return;
    }
    back *= std::max(0.0, unspent_j / cost);
  }
  model.shift_m = shift;
}

// Without load delta_0 costs nothing: it sinks until the surface touches the tool.
void recover_unloaded(ElementModel& model, const ElementResponse& response) {
  const Real touch = std::min({model.touch_m[0], model.touch_m[1], model.touch_m[2]});
  model.shift_m = std::clamp(response.depth_m - touch, 0.0, model.shift_m);
}

// What the curves themselves would store at this depth.
Real storable_j(ElementModel& model, const ElementCache& cache, const Vector3& x,
                const ElementResponse& response) {
  if (!(model.shift_m > 0.0)) {
    return response.normal_j;
  }
  const Real shift = std::exchange(model.shift_m, 0.0);
  const Real whole_j = respond(model, cache, x).normal_j;
  model.shift_m = shift;
  return whole_j;
}

// k_t for the present response, and what changed since the work was booked: paid, and
// booked.
void settle(ElementModel& model, const ElementCache& cache, PassivityLedger& ledger,
            const ElementModelLimits& limits, const Vector3& x, Real dt_s,
            ElementResponse& response) {
  if (response.loaded && has_friction(model)) {
    model.friction_n_per_m =
        model.friction * std::max(0.0, response.normal_n) / model.presliding_m;
    response.friction_j =
        0.5 * model.friction_n_per_m * response.presliding_m.squaredNorm();
  }
  note_shortfall(ledger, response.potential_j());
  const Real allowed = not_above(allowance_j(ledger));
  pay(model, cache, x, allowed, response);
  if (model.shift_m > 0.0 && response.loaded) {
    recover_loaded(model, cache, x, allowed - response.potential_j(),
                   limits.recovery_m_per_s * dt_s, response);
  } else if (model.shift_m > 0.0) {
    recover_unloaded(model, response);
  }
  const Real keep = response.touching ? storable_j(model, cache, x, response) : 0.0;
  book_change(ledger, response.potential_j(), keep);
}

// Half a tick passes where the tool is. @returns whether the response has changed.
bool relax_here(ElementModel& model, const ElementCache& cache, SurfaceMemory& memory,
                PassivityLedger& ledger, const Vector3& x, Real half_s) {
  const Real time_s = pass_time(memory, half_s);
  if (!(time_s > 0.0)) {
    return false;
  }
  const Real y = relaxing_depth_m(model, x);
  if (is_above(model.contact, y + model.shift_m)) {
    leave_alone(model.contact, memory, ledger, time_s);
    return false;
  }
  relax(model.contact, memory, ledger, cache, y, time_s);
  return true;
}

}  // namespace

void relax_before(ElementModel& model, const ElementCache& cache, SurfaceMemory& memory,
                  PassivityLedger& ledger, const Vector3& x_m, Real half_s) noexcept {
  (void)relax_here(model, cache, memory, ledger, x_m, half_s);
}

ElementResponse advance(ElementModel& model, ElementCache& cache, SurfaceMemory& memory,
                        PassivityLedger& ledger, const ElementModelLimits& limits,
                        const Vector3& x_m, Real dt_s) noexcept {
  // 1. Work of the movement under the model of the last tick, (14) of the paper.
  const Real radius = limits.tool_radius_m;
  ElementResponse response = respond_here(model, cache, x_m);
  book_work(ledger, response.potential_j());

  // 2. Another element, then sliding: both move the contact point, and pin the element
  // in use.
  const bool moved = change_element(model, cache, response, x_m, radius);
  if (model.slot < 0) {
    return response;
  }
  cache.pinned = model.slot;
  if (moved) {
    response = respond_anew(model, cache, memory, x_m);
  }
  const bool slid = slide(model, cache, response, x_m, radius);
  if (slid) {
    cache.pinned = model.slot;
    response = respond_anew(model, cache, memory, x_m);
  }
  if (!model.outside) {
    model.received_inside = cache.received;
  }
  // 3. With memory the ledger balances both before time passes. Then half the tick's
  // time relaxes, and what the depth asks for yields.
  Real recovery_s = dt_s;
  if (remembers(memory)) {
    if (moved || slid) {
      settle(model, cache, ledger, limits, x_m, std::exchange(recovery_s, Real(0.0)),
             response);
    }
    if (relax_here(model, cache, memory, ledger, x_m, 0.5 * dt_s)) {
      response = respond_here(model, cache, x_m);
    }
    if (yield(model.contact, memory, cache)) {
      response = respond_here(model, cache, x_m);
      book_yielding(ledger, response.potential_j());
    }
  }
  // 4. k_t, delta_0 and the account for the response as it is now.
  settle(model, cache, ledger, limits, x_m, recovery_s, response);
  return response;
}

}  // namespace palpate
