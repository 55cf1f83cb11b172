#include "runtime/fast/fast_step.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "runtime/fast/element_walk.h"
#include "runtime/memory/relaxation_step.h"
#include "runtime/memory/yield_step.h"

namespace palpate {
namespace {

SafetyLimits safety_limits(const FastConfig& config) {
  return {config.force_max_n, config.slew_max_n_per_s,
          passive(config.model) ? config.energy_floor_j
                                : std::numeric_limits<Real>::infinity(),
          config.ramp_s};
}

Real scalar_depth_m(const FastState& state, const Vector3& x_m) {
  return (state.element.rest_m - x_m).dot(state.element.direction);
}

// Depth at which the first node that counts is touched, or the dent.
Real touch_m(const ElementModel& model, const ElementCache& cache) {
  const YieldingPlace& yielded = model.contact.yielded;
  const Real stays_m = model.contact.remembers ? yielded.dent_m.value : Real(0.0);
  if (model.contact.remembers && model.contact.bundle[0].touched) {
    return stays_m + yielded.elastic_depth_m(model.contact.bundle[0].dent.depth_m);
  }
  const Element& element = cache.element[static_cast<std::size_t>(model.slot)];
  Real first = std::numeric_limits<Real>::infinity();
  for (std::size_t j = 0; j < 3; ++j) {
    if (element.node[j].samples > 0 && model.area(static_cast<Eigen::Index>(j)) > 0.0) {
      first = std::min(first, model.touch_m[j]);
    }
  }
  return stays_m + (std::isfinite(first) ? first : Real(0.0));
}

// The slow simulation's value: the response of the element last called active. It also
// fixes the axis along which the scalar model acts from here on.
void update_scalar(FastState& state, const Vector3& x) {
  state.update_due = false;
  if (state.cache.newest_active < 0) {
    return;
  }
  adopt(state.element, state.cache, state.cache.newest_active, x,
        state.config.tool_radius_m);
  read_memory(state.element, state.memory, &state.memory, state.cache);
  state.cache.pinned = state.element.slot;
  ElementResponse at = respond_here(state.element, state.cache, x);
  if (yield(state.element.contact, state.memory, state.cache)) {
    at = respond_here(state.element, state.cache, x);
  }
  update(state.scalar, state.ledger,
         {at.depth_m, at.normal_n, at.stiffness_n_per_m, at.normal_j,
          touch_m(state.element, state.cache)});
}

// The slow simulation relaxes where it was asked last, at the tool's depth. Its energy
// is none of the local model's, whose changes the ledger pays for at the next update.
void relax_scalar(FastState& state, const Vector3& x, Real half_s) {
  const Real time_s = pass_time(state.memory, half_s);
  PassivityLedger own{.dent_j = std::numeric_limits<Real>::max()};
  const Real depth_m = scalar_depth_m(state, x);
  if (time_s > 0.0 && !is_above(state.element.contact, depth_m)) {
    relax(state.element.contact, state.memory, own, state.cache, depth_m, time_s);
  } else if (time_s > 0.0) {
    leave_alone(state.element.contact, state.memory, own, time_s);
  }
}

Vector3 advance_scalar(FastState& state, const Vector3& x, Real dt_s,
                       FastCommand& command) {
  state.scalar.kind = state.config.model;
  advance(state.scalar, state.ledger, scalar_depth_m(state, x), dt_s);
  if (state.update_due) {
    update_scalar(state, x);
  }
  if (remembers(state.memory)) {
    relax_scalar(state, x, 0.5 * dt_s);
  }
  const Real depth = scalar_depth_m(state, x);
  const Real force = force_n(state.scalar, depth);
  command.depth_m = depth;
  command.in_contact = force > 0.0;
  return force * state.element.direction;
}

Vector3 advance_element(FastState& state, const Vector3& x, Real dt_s,
                        FastCommand& command) {
  const ElementModelLimits limits{state.config.tool_radius_m,
                                  state.config.recovery_m_per_s};
  const ElementResponse response =
      advance(state.element, state.cache, state.memory, state.ledger, limits, x, dt_s);
  command.depth_m = response.depth_m;
  command.in_contact = response.touching;
  command.extrapolated = response.extrapolated;
  command.starved = state.element.starved;
  command.rest_offset_m = state.element.shift_m;
  return force_n(state.element, response);
}

Vector3 advance_potential(FastState& state, const Vector3& x, Real dt_s,
                          FastCommand& command) {
  const ElementModelLimits limits{state.config.tool_radius_m,
                                  state.config.recovery_m_per_s,
                                  field_kind(state.config.model)};
  const Vector3 force = advance(state.potential, state.cache, state.memory,
                                state.ledger, limits, x, dt_s);
  const FieldResponse& response = state.potential.response;
  command.depth_m = response.depth_m;
  command.in_contact = response.touching;
  command.extrapolated = response.extrapolated;
  command.starved = state.potential.place.starved;
  command.rest_offset_m = state.potential.shift_m;
  return force;
}

Vector3 advance_model(FastState& state, const Vector3& x, Real dt_s,
                      FastCommand& command) {
  switch (state.config.model) {
    case LocalModel::kElement:
      return advance_element(state, x, dt_s, command);
    case LocalModel::kPotential:
    case LocalModel::kFacets:
      return advance_potential(state, x, dt_s, command);
    default:
      return advance_scalar(state, x, dt_s, command);
  }
}

ElementModelLimits field_limits(const FastConfig& config) {
  return {config.tool_radius_m, config.recovery_m_per_s, field_kind(config.model)};
}

Vector3 advance_needle(FastState& state, const Vector3& x, const Vector3& moved,
                       Real dt_s, FastCommand& command) {
  // The field's own account while the field advances.
  const PunctureRules& rules = state.config.puncture;
  state.ledger.stored_j -= static_cast<double>(held_j(rules, state.needle));
  const Vector3 field_n = advance_model(state, image_m(state.needle, x), dt_s, command);
  const Vector3 force_n = advance(rules, state.needle,
                                  {state.potential, state.cache, state.memory,
                                   state.ledger, field_limits(state.config)},
                                  field_n, x, moved, dt_s);
  command.depth_m = state.potential.response.depth_m;
  command.in_contact = command.in_contact || state.needle.active >= 0;
  return force_n;
}

// A sum of products with zero is zero, or not a number where one of them is infinite or
// none: several at a time, without a branch for each.
template <std::size_t N>
Real zero_if_finite(const std::array<Real, N>& values, Eigen::Index count = N) {
  using Reals = Eigen::Map<const Eigen::Array<Real, Eigen::Dynamic, 1>>;
  return (Reals(values.data(), count) * Real(0.0)).sum();
}

bool is_finite(const ElementNode& node) {
  // Too many are refused by the cache.
  const auto n = std::clamp<std::int32_t>(node.samples, 0, kElementSamples);
  const Real sum = zero_if_finite(node.position_m) + zero_if_finite(node.normal) +
                   zero_if_finite(node.direction) + zero_if_finite(node.tilt) +
                   zero_if_finite(node.tilt_by_height_per_m) +
                   zero_if_finite(std::array{node.touch_offset_m, node.friction,
                                             node.presliding_m}) +
                   zero_if_finite(node.lateral) + zero_if_finite(node.depth_m, n) +
                   zero_if_finite(node.force_n, n) +
                   zero_if_finite(node.stiffness_n_per_m, n) +
                   zero_if_finite(node.energy_j, n);
  return sum == Real(0.0);
}

// The cache's slot of the element in use; -1: none yet.
int used_slot(const FastState& state) noexcept {
  return is_field(state.config.model) ? state.potential.place.slot : state.element.slot;
}

// NaN in dt or position is a fault before it can reach the account.
void check_input(FastState& state, const FastSample& sample, Real dt_s) {
  if (!sample.position_m.allFinite()) {
    raise_fault(state, Fault::kNotFinite);
  }
  if (!(dt_s >= 0.0 && dt_s <= kLongestStepS)) {
    raise_fault(state, Fault::kTimeStep);
  }
}

}  // namespace

bool is_finite(const Element& element) noexcept {
  return std::isfinite(element.touch_height_m) &&
         std::all_of(element.node.begin(), element.node.end(),
                     [](const ElementNode& node) {
                       return is_finite(node);
                     });
}

const char* check(const FastConfig& config) noexcept {
  if (!(config.tool_radius_m >= 0.0) || !std::isfinite(config.tool_radius_m)) {
    return "tool radius must be finite and not negative";
  }
  if (!(config.force_max_n > 0.0)) {
    return "force limit must be positive";
  }
  if (!(config.slew_max_n_per_s > 0.0)) {
    return "slew limit must be positive";
  }
  if (!(config.energy_floor_j > 0.0)) {
    return "energy floor must be positive";
  }
  if (!(config.recovery_m_per_s >= 0.0) || !std::isfinite(config.recovery_m_per_s)) {
    return "recovery speed must be finite and not negative";
  }
  if (!(config.ramp_s >= 0.0) || !std::isfinite(config.ramp_s)) {
    return "start-up ramp must be finite and not negative";
  }
  if (config.ramp_s > 0.0 && !std::isfinite(config.force_max_n)) {
    return "start-up ramp needs a finite force limit, which it raises";
  }
  if (config.puncture.materials > 0 && !is_field(config.model)) {
    return "a needle needs the model potential or facets";
  }
  return check(config.puncture);
}

void accept(FastState& state, const Element& element) noexcept {
  if (!is_finite(element)) {
    raise_fault(state, Fault::kNotFinite);
    return;
  }
  if (store(state.cache, element)) {
    take_terms(state.memory, element.memory);
  }
  state.update_due = state.update_due || element.active;
}

FastCommand step(FastState& state, const FastSample& sample, Real dt_s) noexcept {
  FastCommand command;
  check_input(state, sample, dt_s);
  if (state.safety.fault == Fault::kNone) {
    const Vector3& x = sample.position_m;
    const Vector3 moved =
        state.sampled ? Vector3(x - state.latest.position_m) : Vector3::Zero();
    // 1. Half the tick's time relaxes where the tool was. 2. The model follows the tool
    // and books work and changes. 3. Limits act on the force.
    const PassivityLedger before = state.ledger;
    relax_ahead(state, dt_s);
    state.relaxed_ahead = false;
    const Vector3 wanted = is_needle(state.config.puncture)
                               ? advance_needle(state, x, moved, dt_s, command)
                               : advance_model(state, x, dt_s, command);
    command.force_n = make_safe(state.safety, safety_limits(state.config), state.ledger,
                                wanted, moved, dt_s);
    // A force that is not a number leaves the account as the last tick left it.
    if (state.safety.fault == Fault::kNotFinite) {
      state.ledger = before;
    }
    state.latest = sample;
    state.sampled = true;
  }
  // A fault of this tick or of one before commands zero force.
  if (state.safety.fault != Fault::kNone) {
    command = {};
    state.safety.force_n.setZero();
  }
  if (command.in_contact && remembers(state.memory)) {
    const RelaxingContact& at =
        is_field(state.config.model) ? state.potential.contact : state.element.contact;
    command.carried_n = carried_n(at);
    command.dent_m = at.remembers ? at.yielded.dent_m.value : Real(0.0);
  }
  state.in_contact = command.in_contact;
  command.stored_j = state.ledger.stored_j;
  command.tank_j = state.ledger.tank_j;
  command.memory_j = state.ledger.dent_j + state.ledger.left_j;
  command.dissipated_j = state.ledger.dissipated_j;
  command.yielded_j = state.ledger.yielded_j;
  command.fault = static_cast<std::uint8_t>(state.safety.fault);
  return command;
}

void relax_ahead(FastState& state, Real dt_s) noexcept {
  if (!remembers(state.memory) || state.relaxed_ahead) {
    return;
  }
  state.relaxed_ahead = true;
  const Real half_s = 0.5 * dt_s;
  const Vector3& x = state.latest.position_m;
  switch (state.config.model) {
    case LocalModel::kPotential:
    case LocalModel::kFacets:
      relax_before(state.potential, state.cache, state.memory, state.ledger,
                   state.config.tool_radius_m, half_s);
      break;
    case LocalModel::kElement:
      relax_before(state.element, state.cache, state.memory, state.ledger, x, half_s);
      break;
    default:
      relax_scalar(state, x, half_s);
  }
}

void delivered(FastState& state, const Vector3& force_n) noexcept {
  if (force_n.allFinite() && state.safety.fault == Fault::kNone) {
    state.safety.delivered_n = force_n;
  }
}

std::int32_t active_triangle(const FastState& state) noexcept {
  const int used = used_slot(state);
  return used < 0 ? -1 : state.cache.element[static_cast<std::size_t>(used)].triangle;
}

FastContact contact(const FastState& state) noexcept {
  FastContact at;
  at.time_ns = state.latest.time_ns;
  at.tool_m = image_m(state.needle, state.latest.position_m);
  at.in_contact = state.in_contact;
  const bool field = is_field(state.config.model);
  const FieldPlace& place = state.potential.place;
  const int used = used_slot(state);
  if (used >= 0) {
    const Element& element = state.cache.element[static_cast<std::size_t>(used)];
    // Normal: sum w_j n_j, made a unit. Point: sum w_j v_j, or foot_m() of the field.
    const Vector3& weight = field ? place.weight : state.element.area;
    for (std::size_t j = 0; j < 3; ++j) {
      const Real part = weight(static_cast<Eigen::Index>(j));
      const ElementNode& node = element.node[j];
      if (!field) {
        at.point_m += part * Eigen::Map<const Vector3>(node.position_m.data());
      }
      at.normal += part * Eigen::Map<const Vector3>(node.normal.data());
    }
    if (field) {
      at.point_m = foot_m(place);
    }
    const Real length = at.normal.norm();
    if (length > 0.0) {
      at.normal /= length;
    }
    at.triangle = element.triangle;
    at.starved = field ? place.starved : state.element.starved;
  }
  return at;
}

ContactPlace contact_place(const FastState& state) noexcept {
  const FastContact one = contact(state);
  ContactPlace at;
  at.centre_m = one.tool_m;
  at.point_m = one.point_m;
  at.normal = one.normal;
  at.force_n = state.safety.force_n;
  at.triangle = one.triangle;
  at.touching = one.in_contact;
  at.starved = one.starved;
  if (one.triangle < 0) {
    return at;
  }
  const bool field = is_field(state.config.model);
  at.share = field ? shares_of(state.potential.place, one.point_m) : state.element.area;
  at.depth_m = field ? state.potential.response.depth_m
                     : scalar_depth_m(state, state.latest.position_m);
  return at;
}

Real potential_j(const FastState& state, const Vector3& x_m) noexcept {
  if (state.config.model == LocalModel::kElement) {
    return respond(state.element, state.cache, x_m).potential_j();
  }
  if (is_field(state.config.model)) {
    return moved_energy_j(state.potential, state.cache, state.memory,
                          state.config.tool_radius_m, image_m(state.needle, x_m)) +
           moved_held_j(state.config.puncture, state.needle,
                        x_m - state.latest.position_m);
  }
  return energy_j(state.scalar, scalar_depth_m(state, x_m));
}

void raise_fault(FastState& state, Fault fault) noexcept {
  raise_fault(state.safety, fault);
}

}  // namespace palpate
