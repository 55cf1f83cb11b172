#include "runtime/fast/potential_model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "runtime/fast/relaxed_shift.h"

namespace palpate {
namespace {

// A field that is one function changes by no more than this many times the force times
// the movement; more is a leap to another sheet of it.
constexpr double kLeap = 4.0;
constexpr double kLeapJ = 1e-15;

// The element's Coulomb coefficient and presliding limit at the contact point.
struct Friction {
  double coefficient = 0.0;
  double presliding_m = 0.0;
  [[nodiscard]] bool any() const { return coefficient > 0.0 && presliding_m > 0.0; }
};

Friction friction_at(const FieldPlace& place, const ElementCache& cache) {
  Friction friction;
  const Element& element = cache.element[static_cast<std::size_t>(place.slot)];
  for (std::size_t j = 0; j < 3; ++j) {
    const double weight =
        std::max(0.0, place.frame.weight(static_cast<Eigen::Index>(j)));
    friction.coefficient += weight * element.node[j].friction;
    friction.presliding_m += weight * element.node[j].presliding_m;
  }
  return friction;
}

void release(PotentialModel& model) {
  model.friction_n_per_m = 0.0;
  model.presliding_m.setZero();
}

double spring_j(const PotentialModel& model) {
  return 0.5 * model.friction_n_per_m * model.presliding_m.squaredNorm();
}

std::int32_t triangle_in(const ElementCache& cache, int slot) {
  return cache.triangle[static_cast<std::size_t>(slot)];
}

FieldResponse respond(PotentialModel& model, const ElementCache& cache, double radius) {
  return respond(model.place, cache, radius, model.shift_m, model.pieces);
}

// What fixes the continuation of what was rendered at x_k.
struct Rendered {
  int slot = -1;
  double height_m = 0.0;
  Eigen::Vector3d weight;
  Eigen::Vector3d normal;
  FieldResponse response;
};

Rendered rendered(const PotentialModel& model) {
  return {model.place.slot, model.place.at.height_m, model.place.frame.weight,
          model.place.frame.normal, model.response};
}

// What was rendered until now, continued by this movement.
double carried_j(const Rendered& at, const ElementCache& cache, double radius,
                 double shift_m, const Eigen::Vector3d& moved) {
  FieldPlace along;
  along.slot = at.slot;
  along.folded = true;
  along.at.height_m = at.height_m + at.normal.dot(moved);
  along.frame.weight = at.weight;
  CurvePieces pieces;
  const double energy = respond(along, cache, radius, shift_m, pieces).energy_j;
  const Eigen::Vector3d& f = at.response.force_n;
  const Eigen::Vector3d along_n = f - f.dot(at.normal) * at.normal;
  return std::max(0.0, energy - along_n.dot(moved));
}

bool leapt(const FieldResponse& from, const FieldResponse& to,
           const Eigen::Vector3d& moved) {
  const double force2 = std::max(from.force_n.squaredNorm(), to.force_n.squaredNorm());
  const double most = kLeap * std::sqrt(force2 * moved.squaredNorm()) + kLeapJ;
  return !(std::abs(to.energy_j - from.energy_j) <= most);
}

// Moves the model to x. @return the energy of what was rendered until now, at x; the
// model's response is that of the field there, which may hold another energy.
double move(PotentialModel& model, const ElementCache& cache, double radius,
            const Eigen::Vector3d& x) {
  FieldPlace& place = model.place;
  const Eigen::Vector3d moved = x - model.tool_m;
  const Rendered before = rendered(model);
  const bool sound = !place.folded && !place.outside && !place.prism.flat;
  double energy = -1.0;
  if (place.outside) {
    FieldPlace within = place;
    if (follow_within(within, x)) {
      energy = respond(within, cache, radius, model.shift_m, model.pieces).energy_j;
    }
  }
  follow(place, cache, x);
  model.response = respond(model, cache, radius);
  model.tool_m = x;
  if (sound && !place.folded && !leapt(before.response, model.response, moved)) {
    return model.response.energy_j;
  }
  return energy >= 0.0 ? energy
                       : carried_j(before, cache, radius, model.shift_m, moved);
}

// Another element where the rules allow it: in free space, or lost beyond an edge, the
// one the slow process last called active; else a newer copy of the same triangle.
void change_element(PotentialModel& model, const ElementCache& cache, double radius,
                    const Eigen::Vector3d& x) {
  const bool news = cache.received != model.received_seen;
  model.received_seen = cache.received;
  if (!news && !model.place.outside) {
    return;
  }
  const int active = cache.newest_active;
  const int here = model.place.slot;
  const bool another = active >= 0 && (here < 0 || triangle_in(cache, active) !=
                                                       triangle_in(cache, here));
  const bool lost =
      model.place.outside && active >= 0 &&
      cache.stored_at[static_cast<std::size_t>(active)] > model.received_inside;
  if (another && (here < 0 || !model.response.touching || lost)) {
    release(model);
    model.tool_m = x;
    adopt(model.place, cache, active, x);
    model.received_inside = cache.received;
  } else if (here >= 0) {
    const int newer = find(cache, triangle_in(cache, here));
    if (newer == here) {
      return;
    }
    move_to_copy(model.place, cache, newer);
  }
  if (model.place.slot >= 0) {
    model.response = respond(model, cache, radius);
  }
}

// The spring for the normal force at the new place: turned into its tangent plane, its
// anchor shifted where k_t grows, cut at the presliding limit.
void set_spring(PotentialModel& model, const ElementCache& cache) {
  const Friction friction = friction_at(model.place, cache);
  if (!model.response.loaded || !friction.any()) {
    release(model);
    return;
  }
  const double before = model.friction_n_per_m;
  const double now =
      friction.coefficient * model.response.normal_n / friction.presliding_m;
  model.friction_n_per_m = now;
  Eigen::Vector3d& t = model.presliding_m;
  const double length2 = t.squaredNorm();
  if (!(length2 > 0.0)) {
    return;
  }
  const Eigen::Vector3d& n = model.place.frame.normal;
  t -= t.dot(n) * n;
  const double in_plane2 = t.squaredNorm();
  const double kept2 = now > before ? length2 * before / now : length2;  // (23)
  const double limit2 = friction.presliding_m * friction.presliding_m;
  if (in_plane2 > 0.0) {
    t *= std::sqrt(std::min(kept2, limit2) / in_plane2);
  }
}

// Brings the changed model down to the allowance: friction spring first, then delta_0.
void pay(PotentialModel& model, const ElementCache& cache, double radius,
         double allowed_j) {
  const double spring = spring_j(model);
  if (model.response.energy_j + spring <= allowed_j) {
    return;
  }
  if (spring > 0.0) {
    const double kept_j = std::max(0.0, allowed_j - model.response.energy_j);
    model.presliding_m *= std::sqrt(kept_j / spring);  // (23)
  }
  if (model.response.energy_j > allowed_j) {
    model.presliding_m.setZero();
    const auto at_shift = [&](double shift_m) {
      const FieldResponse at =
          respond(model.place, cache, radius, shift_m, model.pieces);
      return ShiftedEnergy{shift_m, at.energy_j, at.normal_n};
    };
    model.shift_m = raised_shift_m(
        {model.shift_m, model.response.energy_j, model.response.normal_n},
        unloading_shift_m(model.place, cache, radius), allowed_j, at_shift);
    model.response = respond(model, cache, radius);
  }
}

// delta_0 sinks back: at once where nothing is loaded, else as time and the unspent
// allowance permit.
void recover(PotentialModel& model, const ElementCache& cache, double radius,
             double unspent_j, double step_m) {
  if (!model.response.loaded) {
    model.shift_m =
        std::min(model.shift_m, unloading_shift_m(model.place, cache, radius));
    return;
  }
  const auto at_shift = [&](double shift_m) {
    const FieldResponse at = respond(model.place, cache, radius, shift_m, model.pieces);
    return ShiftedEnergy{shift_m, at.energy_j, at.normal_n};
  };
  const double shift = recovered_shift_m(
      {model.shift_m, model.response.energy_j, model.response.normal_n}, step_m,
      unspent_j, at_shift);
  if (shift != model.shift_m) {
    model.shift_m = shift;
    model.response = respond(model, cache, radius);
  }
}

// The tool's tangential movement stretches the spring.
void stretch(PotentialModel& model, const Eigen::Vector3d& x) {
  if (model.friction_n_per_m > 0.0) {
    const Eigen::Vector3d& n = model.place.frame.normal;
    const Eigen::Vector3d moved = x - model.tool_m;
    model.presliding_m += moved - moved.dot(n) * n;
  }
}

}  // namespace

double moved_energy_j(PotentialModel model, const ElementCache& cache,
                      double tool_radius_m, const Eigen::Vector3d& x_m) noexcept {
  if (model.place.slot < 0) {
    return 0.0;
  }
  stretch(model, x_m);
  return move(model, cache, tool_radius_m, x_m) + spring_j(model);
}

Eigen::Vector3d advance(PotentialModel& model, ElementCache& cache,
                        PassivityLedger& ledger, const ElementModelLimits& limits,
                        const Eigen::Vector3d& x_m, double dt_s) noexcept {
  const double radius = limits.tool_radius_m;
  if (model.place.slot >= 0) {
    stretch(model, x_m);
    const double moved_j = move(model, cache, radius, x_m);
    book_work(ledger, moved_j + spring_j(model));
  }
  change_element(model, cache, radius, x_m);
  if (model.place.slot < 0) {
    return Eigen::Vector3d::Zero();
  }
  cache.pinned = model.place.slot;
  if (!model.place.outside) {
    model.received_inside = cache.received;
  }
  set_spring(model, cache);
  note_shortfall(ledger, model.response.energy_j + spring_j(model));
  const double allowed = allowance_j(ledger);
  pay(model, cache, radius, allowed);
  if (model.shift_m > 0.0) {
    const double unspent = allowed - model.response.energy_j - spring_j(model);
    recover(model, cache, radius, unspent, limits.recovery_m_per_s * dt_s);
  }
  double keep = model.response.touching ? model.response.energy_j : 0.0;
  if (model.shift_m > 0.0 && model.response.touching) {
    keep = respond(model.place, cache, radius, 0.0, model.pieces).energy_j;
  }
  book_change(ledger, model.response.energy_j + spring_j(model), keep);
  return model.response.force_n - model.friction_n_per_m * model.presliding_m;
}

}  // namespace palpate
