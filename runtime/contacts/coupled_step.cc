#include "runtime/contacts/coupled_step.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>

#include <Eigen/LU>

#include "runtime/contacts/wrench_vector.h"
#include "runtime/element/triangle.h"

namespace palpate {
namespace {

// Distance of R^T R from 1 that still makes a rotation.
constexpr Real kTurnedAway = rounding(1e-6, 1e-4);

void check_sample(CoupledState& state, const PoseSample& sample, Real dt_s) {
  for (int port = 0; port < state.set.ports; ++port) {
    if (!is_sound(sample.pose[static_cast<std::size_t>(port)])) {
      raise_fault(state, Fault::kNotFinite);
    }
  }
  if (!(dt_s >= 0.0 && dt_s <= kLongestStepS)) {
    raise_fault(state, Fault::kTimeStep);
  }
}

WrenchCommand step_alone(CoupledState& state, const PoseSample& sample, Real dt_s) {
  WrenchCommand command;
  const Vector3 centre = centre_of(state.set, sample.pose, 0);
  const FastCommand made = step(*state.alone, {centre, sample.time_ns}, dt_s);
  Wrench& wrench = command.wrench[0];
  wrench.force_n = made.force_n;
  wrench.torque_n_m = (centre - sample.pose[0].position_m).cross(made.force_n);
  static_cast<TickAccount&>(command) = made;
  command.contacts = made.in_contact ? 1 : 0;
  state.latest = sample;
  state.in_contact = made.in_contact;
  return command;
}

void describe(const CoupledState& state, WrenchCommand& command) {
  const CoupledModel& model = state.model;
  const CoupledContacts& c = model.field.equilibrium;
  command.in_contact = model.loaded;
  command.scaled = c.scale < 1.0;
  command.rest_offset_m = model.field.shift_m;
  command.carried_n =
      model.field.remembers ? model.field.carried_n.head(state.set.count).sum() : 0.0;
  for (int i = 0; i < state.set.count; ++i) {
    const auto self = static_cast<std::size_t>(i);
    const ContactReading& reading = model.contact[self].reading;
    command.contacts += reading.loaded ? 1 : 0;
    command.extrapolated = command.extrapolated || reading.extrapolated;
    const FieldPlace& place = model.field.at[self].place;
    if (place.slot >= 0) {
      command.starved = command.starved || place.starved;
      command.depth_m = std::max(command.depth_m, c.depth_m(i) + model.field.shift_m);
    }
  }
}

// With the first contact that has the same responses.
void share_yielded(const CoupledState& state, int i) {
  const auto& sphere = state.set.sphere;
  int first = 0;
  while (sphere[static_cast<std::size_t>(first)].table !=
         sphere[static_cast<std::size_t>(i)].table) {
    ++first;
  }
  state.surfaces[i].memory.shared = &state.surfaces[first].memory.yielded;
}

// But for what has yielded. @param yielded of its memory
template <typename Remembering>
void make_anew(Remembering& all, const YieldedSites& yielded) {
  const YieldedSites kept = yielded;
  std::construct_at(&all);
  all.memory.yielded = kept;
}

}  // namespace

bool is_sound(const PortPose& pose) noexcept {
  return pose.position_m.allFinite() && pose.rotation.allFinite() &&
         (pose.rotation.transpose() * pose.rotation - Matrix3::Identity())
                 .cwiseAbs()
                 .maxCoeff() <= kTurnedAway &&
         pose.rotation.determinant() > 0.0;
}

const char* check(const CoupledSet& set, const FastConfig& config) noexcept {
  if (set.count < 1 || set.count > kContactsMax) {
    return "a tool has 1 to 64 contacts";
  }
  if (!is_alone(set) && !is_field(config.model)) {
    return "several contacts are rendered by the models \"potential\" and \"facets\"";
  }
  return check(config);
}

void begin(CoupledState& state) noexcept {
  state.set.field = field_kind(state.config.model);
  if (is_alone(state.set) && state.alone != nullptr) {
    state.alone->config = state.config;
    state.alone->config.tool_radius_m = state.set.sphere[0].radius_m;
  }
  for (int i = 0; i < state.set.count && !is_alone(state.set); ++i) {
    share_yielded(state, i);
  }
}

void restart(CoupledState& state) noexcept {
  if (is_alone(state.set)) {
    make_anew(*state.alone, state.alone->memory.yielded);
  }
  for (int i = 0; i < state.set.count && !is_alone(state.set); ++i) {
    make_anew(state.surfaces[i], state.surfaces[i].memory.yielded);
  }
  begin(state);
  std::construct_at(&state.model);
  state.ledger = {};
  state.safety = {};
  state.latest = {};
  state.sampled = false;
  state.in_contact = false;
  state.relaxed_ahead = false;
}

void accept(CoupledState& state, const ContactElement& message) noexcept {
  if (is_alone(state.set)) {
    accept(*state.alone, message.element);
    return;
  }
  if (message.contact < 0 || message.contact >= state.set.count) {
    return;
  }
  if (!is_finite(message.element)) {
    raise_fault(state, Fault::kNotFinite);
    return;
  }
  (void)store(state.surfaces[message.contact], message);
}

void relax_ahead(CoupledState& state, Real dt_s) noexcept {
  if (is_alone(state.set)) {
    relax_ahead(*state.alone, dt_s);
  } else if (!state.relaxed_ahead) {
    state.relaxed_ahead = true;
    relax_before(state.model, state.scratch, state.set, state.surfaces, state.ledger,
                 Real(0.5) * dt_s);
  }
}

WrenchCommand step(CoupledState& state, const PoseSample& sample, Real dt_s) noexcept {
  check_sample(state, sample, dt_s);
  if (is_alone(state.set)) {
    return step_alone(state, sample, dt_s);
  }
  WrenchCommand command;
  if (state.safety.fault == Fault::kNone) {
    const PortPoses& from = state.sampled ? state.latest.pose : sample.pose;
    // Safety limits one vector of all ports. A torque counts in it as a force at the
    // port's lever [N], a turn as a way [m].
    const WrenchSafety::Vector moved = movement(state.set, from, sample.pose);
    const PassivityLedger before = state.ledger;
    relax_ahead(state, dt_s);
    state.relaxed_ahead = false;
    const PortWrenches wanted =
        advance(state.model, state.scratch, state.set, state.surfaces, state.ledger,
                sample.pose, state.config.recovery_m_per_s, dt_s);
    const SafetyLimits limits{state.config.force_max_n, state.config.slew_max_n_per_s,
                              state.config.energy_floor_j, state.config.ramp_s};
    command.wrench =
        unflattened(state.set, make_safe(state.safety, limits, state.ledger,
                                         flattened(state.set, wanted), moved, dt_s));
    // A force that is not a number leaves the account as the last tick left it.
    if (state.safety.fault == Fault::kNotFinite) {
      state.ledger = before;
    }
    state.latest = sample;
    state.sampled = true;
    describe(state, command);
  }
  if (state.safety.fault != Fault::kNone) {
    command = {};
    state.safety.force_n.setZero();
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

void carry(CoupledState& state, const PortPoses& pose) noexcept {
  for (int port = 0; port < state.set.ports; ++port) {
    if (!is_sound(pose[static_cast<std::size_t>(port)])) {
      raise_fault(state, Fault::kNotFinite);
    }
  }
  if (is_alone(state.set) || state.safety.fault != Fault::kNone || !state.sampled) {
    return;
  }
  carry(state.model, state.scratch, state.set, state.surfaces, state.ledger, pose);
  state.latest.pose = pose;
}

WrenchCommand step_unturned(CoupledState& state, const PoseSample& sample,
                            Real dt_s) noexcept {
  PortPoses turned = state.latest.pose;
  bool any = false;
  for (std::size_t port = 0; port < turned.size(); ++port) {
    any = any || turned[port].rotation != sample.pose[port].rotation;
    turned[port].rotation = sample.pose[port].rotation;
  }
  if (any) {
    carry(state, turned);
  }
  return step(state, sample, dt_s);
}

void delivered(CoupledState& state, const PortWrenches& wrench) noexcept {
  if (is_alone(state.set)) {
    delivered(*state.alone, wrench[0].force_n);
    return;
  }
  const WrenchSafety::Vector v = flattened(state.set, wrench);
  if (v.allFinite() && state.safety.fault == Fault::kNone) {
    state.safety.delivered_n = v;
  }
}

ContactPlace contact_place(const CoupledState& state, int i) noexcept {
  ContactPlace at;
  if (is_alone(state.set)) {
    return contact_place(*state.alone);
  }
  const auto self = static_cast<std::size_t>(i);
  const CoupledContact& contact = state.model.contact[self];
  const FieldPlace& place = state.model.field.at[self].place;
  const CoupledContacts& c = state.model.field.equilibrium;
  at.centre_m = contact.centre_m;
  at.force_n = contact.reading.force_n + contact.spring.force_n();
  if (place.slot < 0) {
    return at;
  }
  at.depth_m = c.depth_m(i) + state.model.field.shift_m;
  at.dimple_m = c.dimple_m(i) + c.scale * c.sunk_m(i);
  at.point_m = foot_m(place);
  at.normal = place.normal;
  at.share = shares_of(place, at.point_m);
  at.triangle = state.surfaces[i].cache.triangle[static_cast<std::size_t>(place.slot)];
  at.touching = contact.reading.touching;
  at.starved = place.starved;
  return at;
}

Real potential_j(CoupledState& state, CoupledModel& moved,
                 const PortPoses& pose) noexcept {
  if (is_alone(state.set)) {
    return potential_j(*state.alone, centre_of(state.set, pose, 0));
  }
  return moved_energy_j(state.model, moved, state.scratch, state.set, state.surfaces,
                        pose);
}

void raise_fault(CoupledState& state, Fault fault) noexcept {
  if (is_alone(state.set)) {
    raise_fault(*state.alone, fault);
    return;
  }
  raise_fault(state.safety, fault);
}

}  // namespace palpate
