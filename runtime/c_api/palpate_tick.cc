// The C interface's haptic functions: nothing here allocates, locks or throws.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <span>

#include "runtime/c_api/host_handles.h"
#include "runtime/c_api/known_struct.h"
#include "runtime/c_api/palpate_draw.h"

namespace {

using palpate::copy_vector;
using palpate::HostSample;
using palpate::Wrench;

int status_of(const palpate::TickAccount& command) noexcept {
  if (command.fault != 0) {
    return -static_cast<int>(command.fault);
  }
  return command.in_contact ? PALPATE_CONTACT : PALPATE_FREE;
}

void zero(double* values, std::size_t count) noexcept {
  if (values != nullptr) {
    std::fill_n(values, count, 0.0);
  }
}

// Of one hand. @param quat_xyzw may be null.
HostSample sample_of(const palpate_tool& tool, const double* position,
                     const double* quat_xyzw, double dt_s, bool torque_felt) noexcept {
  HostSample sample;
  sample.position_m =
      tool.metres_per_unit * Eigen::Map<const Eigen::Vector3d>(position);
  if (quat_xyzw != nullptr) {
    sample.quaternion = Eigen::Map<const Eigen::Vector4d>(quat_xyzw);
  }
  sample.dt_s = dt_s;
  sample.torque_felt = torque_felt;
  return sample;
}

palpate_contact contact_of(const palpate_tool& tool, int i) noexcept {
  const palpate::BodyContact contact = tool.tool.contact_at(i);
  const palpate::ContactPlace& at = contact.at;
  palpate_contact one{};
  one.hand = contact.hand;
  one.table = contact.table;
  one.touching = at.touching ? 1 : 0;
  one.triangle = at.triangle;
  one.radius = contact.radius_m / tool.metres_per_unit;
  copy_vector(at.centre_m, tool.metres_per_unit, one.centre);
  copy_vector(at.point_m, tool.metres_per_unit, one.point);
  copy_vector(at.normal, 1.0, one.normal);
  copy_vector(at.force_n, tool.newtons_per_unit, one.force);
  one.depth = at.depth_m / tool.metres_per_unit;
  one.own_depth = (at.depth_m - at.dimple_m) / tool.metres_per_unit;
  copy_vector(at.share, 1.0, one.shares);
  return one;
}

// @param torque_out may be null.
void copy_wrench(const palpate_tool& tool, const Wrench& wrench, double* force_out,
                 double* torque_out) noexcept {
  copy_vector(wrench.force_n, tool.newtons_per_unit, force_out);
  if (torque_out != nullptr) {
    copy_vector(wrench.torque_n_m, tool.newtons_per_unit * tool.metres_per_unit,
                torque_out);
  }
}

// One tick of a tool of one hand. @param quat_xyzw, torque_out may be null.
int render(palpate_tool* tool, const double* position, const double* quat_xyzw,
           double dt_s, double* force_out, double* torque_out) noexcept {
  zero(force_out, 3);
  zero(torque_out, 3);
  if (tool == nullptr || position == nullptr || force_out == nullptr ||
      tool->tool.hands() != 1) {
    return PALPATE_ERROR_INPUT;
  }
  const palpate::HostTick tick = tool->tool.step(
      sample_of(*tool, position, quat_xyzw, dt_s, torque_out != nullptr));
  copy_wrench(*tool, tick.command.wrench[0], force_out, torque_out);
  return status_of(tick.command);
}

}  // namespace

int palpate_step(palpate_tool* tool, const palpate_pose* poses, size_t hands,
                 double dt_s, palpate_hand_wrench* wrenches_out) {
  std::array<HostSample, palpate::kPortsMax> samples;
  for (size_t hand = 0; wrenches_out != nullptr && hand < hands; ++hand) {
    wrenches_out[hand] = {};
  }
  if (tool == nullptr || poses == nullptr || wrenches_out == nullptr ||
      hands != tool->tool.hands()) {
    return PALPATE_ERROR_INPUT;
  }
  const bool felt = !tool->body.options().forces_alone;
  for (size_t hand = 0; hand < hands; ++hand) {
    samples[hand] =
        sample_of(*tool, poses[hand].position, poses[hand].quat_xyzw, dt_s, felt);
  }
  const palpate::HostTick tick = tool->tool.step(std::span(samples).first(hands));
  for (size_t hand = 0; hand < hands; ++hand) {
    palpate_hand_wrench& out = wrenches_out[hand];
    copy_wrench(*tool, tick.command.wrench[hand], out.force,
                felt ? out.torque : nullptr);
  }
  return status_of(tick.command);
}

int palpate_force(palpate_tool* tool, const double position[3],
                  const double quat_xyzw[4], double dt_s, double force_out[3]) {
  return render(tool, position, quat_xyzw, dt_s, force_out, nullptr);
}

int palpate_wrench(palpate_tool* tool, const double position[3],
                   const double quat_xyzw[4], double dt_s, double force_out[3],
                   double torque_out[3]) {
  if (torque_out == nullptr) {
    zero(force_out, 3);
    return PALPATE_ERROR_INPUT;
  }
  return render(tool, position, quat_xyzw, dt_s, force_out, torque_out);
}

int palpate_together(palpate_tool* tool, const double positions[6],
                     const double quats_xyzw[8], double dt_s, double forces_out[6],
                     double torques_out[6]) {
  zero(forces_out, 6);
  zero(torques_out, 6);
  if (tool == nullptr || positions == nullptr || forces_out == nullptr ||
      tool->tool.hands() != 2) {
    return PALPATE_ERROR_INPUT;
  }
  std::array<HostSample, 2> samples;
  for (size_t hand = 0; hand < 2; ++hand) {
    samples[hand] = sample_of(*tool, positions + 3 * hand,
                              quats_xyzw == nullptr ? nullptr : quats_xyzw + 4 * hand,
                              dt_s, torques_out != nullptr);
  }
  const palpate::HostTick tick = tool->tool.step(samples);
  for (size_t hand = 0; hand < 2; ++hand) {
    copy_wrench(*tool, tick.command.wrench[hand], forces_out + 3 * hand,
                torques_out == nullptr ? nullptr : torques_out + 3 * hand);
  }
  return status_of(tick.command);
}

int palpate_delivered(palpate_tool* tool, const double* force, const double* torque) {
  if (tool == nullptr || force == nullptr) {
    return PALPATE_ERROR_INPUT;
  }
  palpate::PortWrenches made = tool->tool.wanted();
  for (size_t hand = 0; hand < tool->tool.hands(); ++hand) {
    made[hand].force_n =
        tool->newtons_per_unit * Eigen::Map<const Eigen::Vector3d>(force + 3 * hand);
    if (torque != nullptr) {
      made[hand].torque_n_m = tool->newtons_per_unit * tool->metres_per_unit *
                              Eigen::Map<const Eigen::Vector3d>(torque + 3 * hand);
    }
  }
  return tool->tool.delivered(made) ? 0 : PALPATE_ERROR_INPUT;
}

int palpate_contacts_get(const palpate_tool* tool, palpate_contact* contacts,
                         size_t room, size_t contact_bytes) {
  if (tool == nullptr || (room > 0 && contacts == nullptr) ||
      contact_bytes < sizeof(size_t)) {
    return PALPATE_ERROR_INPUT;
  }
  const int count = tool->tool.contacts();
  for (size_t i = 0; i < room && i < static_cast<size_t>(count); ++i) {
    palpate::copy_row(contact_of(*tool, static_cast<int>(i)), contacts, i,
                      contact_bytes);
  }
  return count;
}

void palpate_state_get(palpate_tool* tool, palpate_state* state) {
  if (tool == nullptr || state == nullptr || state->struct_size < sizeof(size_t)) {
    return;
  }
  const palpate::HostTick tick = tool->tool.latest();
  palpate_state all{};
  all.struct_size = state->struct_size;
  all.status = status_of(tick.command);
  all.triangle = tick.contact.triangle;
  copy_vector(tick.contact.point_m, tool->metres_per_unit, all.contact_point);
  copy_vector(tick.contact.normal, 1.0, all.normal);
  all.depth = tick.command.depth_m / tool->metres_per_unit;
  all.work_j = tick.work_j;
  all.stored_j = tick.command.stored_j;
  all.tank_j = tick.command.tank_j;
  all.dissipated_j = tick.command.dissipated_j;
  all.rest_offset = tick.command.rest_offset_m / tool->metres_per_unit;
  all.force_scale = tool->force_scale;
  all.tilt_rad = tick.tilt_rad;
  all.starved = tick.command.starved ? 1 : 0;
  all.extrapolated = tick.command.extrapolated ? 1 : 0;
  all.ticks = tick.ticks;
  all.memory_j = tick.command.memory_j;
  all.relaxed_force = tick.command.carried_n / tool->newtons_per_unit;
  all.yielded_j = tick.command.yielded_j;
  copy_wrench(*tool, tick.command.wrench[0], all.force, all.torque);
  copy_wrench(*tool, tick.command.wrench[1], all.second_force, all.second_torque);
  all.contacts = tick.command.contacts;
  all.coupling_scaled = tick.command.scaled ? 1 : 0;
  all.dent = tick.command.dent_m / tool->metres_per_unit;
  all.answer = tool->grown == nullptr ? PALPATE_ANSWER_FINAL
                                      : static_cast<std::int32_t>(tool->grown->here());
  palpate::copy_known(all, state);
}
