// What a session of contacts shows (contact_session.h).
#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <utility>

#include "runtime/view/contact_session.h"

namespace palpate {
namespace {

// Forces of all contacts by port.
PortWrenches sum_of(CoupledField& field, const CoupledState& state) {
  PortWrenches sum;
  for (int i = 0; i < state.set.count; ++i) {
    const auto port =
        static_cast<std::size_t>(state.set.sphere[static_cast<std::size_t>(i)].port);
    const ContactReading reading = read_contact(field, state.set, state.surfaces, i);
    const Eigen::Vector3d arm =
        centre_of(state.set, state.latest.pose, i) - state.latest.pose[port].position_m;
    sum[port].force_n += reading.force_n;
    sum[port].torque_n_m += arm.cross(reading.force_n);
  }
  return sum;
}

}  // namespace

// The rows of the elements in use are exchanged while this lasts.
std::optional<PortWrenches> ContactSession::elastic(bool coupled) {
  CoupledState& state = storage_->state();
  if (is_alone(state.set) || !state.sampled) {
    return std::nullopt;
  }
  CoupledField& field = *scratch_;
  field = state.model.field;
  field.shift_m = 0.0;
  field.equilibrium.scale = 1.0;
  field.equilibrium.factor.sound = false;
  std::vector<std::array<ContactRow, 3>> kept(kContactsMax);
  const auto exchange = [&](int i, const std::array<ContactRow, 3>& row) {
    const int slot = field.at[static_cast<std::size_t>(i)].place.slot;
    return std::exchange(state.surfaces[i].row[static_cast<std::size_t>(slot)], row);
  };
  for (int i = 0; i < state.set.count; ++i) {
    const auto self = static_cast<std::size_t>(i);
    const int slot = field.at[self].place.slot;
    if (slot >= 0) {
      const std::int32_t triangle =
          state.surfaces[i].cache.triangle[static_cast<std::size_t>(slot)];
      kept[self] = exchange(i, adjusted_.element(i, triangle, coupled).row);
      field.at[self].slot = -1;
      field.at[self].stored_at = 0;
    }
    enter(field, state.set, state.surfaces, i);
  }
  set_places(field, state.set, state.surfaces, Keep::kNo);
  const bool solved = settle_contacts(field, state.set, state.surfaces);
  const PortWrenches sum = sum_of(field, state);
  for (int i = 0; i < state.set.count; ++i) {
    if (field.at[static_cast<std::size_t>(i)].place.slot >= 0) {
      (void)exchange(i, kept[static_cast<std::size_t>(i)]);
    }
  }
  return solved ? std::optional(sum) : std::nullopt;
}

std::vector<ViewTouch> ContactSession::touches() const {
  const CoupledState& state = storage_->state();
  std::vector<ViewTouch> all;
  for (int i = 0; i < state.set.count; ++i) {
    const auto self = static_cast<std::size_t>(i);
    const CoupledContactPlace at = contact_place(state, i);
    if (at.triangle < 0) {
      continue;
    }
    ViewTouch touch{.hand = state.set.sphere[self].port,
                    .radius_m = state.set.sphere[self].radius_m,
                    .centre_m = at.centre_m,
                    .point_m = at.point_m,
                    .normal = at.normal,
                    .force_n = at.force_n,
                    .depth_m = at.depth_m,
                    .own_m = at.depth_m - at.dimple_m,
                    .share = at.share};
    for (Eigen::Index j = 0; j < 3; ++j) {
      touch.node[static_cast<std::size_t>(j)] = database_.body.triangle(at.triangle, j);
    }
    all.push_back(touch);
  }
  return all;
}

ViewHands ContactSession::hands() {
  ViewHands all;
  all.touch = touches();
  all.loads = std::exchange(loads_, {});
  all.coupled = adjusted_.coupled();
  all.scaled = command_.scaled;
  const std::optional<PortWrenches> coupled = elastic(true);
  const std::optional<PortWrenches> added_up = elastic(false);
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    const Held& hand = hands_[i];
    ViewHand& shown = all.hand.emplace_back();
    shown = {.tool_m = pose_[i].position_m,
             .turn = hand.turn,
             .hand_m = hand.pointer.target().position_m,
             .pointer_m = hand.pointer.pointer_m(),
             .holding = hand.holding,
             .force_n = command_.wrench[i].force_n,
             .torque_n_m = command_.wrench[i].torque_n_m};
    if (coupled && added_up) {
      shown.coupled_n = (*coupled)[i].force_n;
      shown.added_up_n = (*added_up)[i].force_n;
    }
  }
  return all;
}

// The deepest of what the contacts of all tables have left at a node.
std::vector<NodeDent> ContactSession::dents() const {
  std::map<std::int32_t, double> by_node;
  for (std::size_t t = 0; t < dents_.size(); ++t) {
    for (const NodeDent& dent :
         dents_[t].at(surface_dents(storage_->state(), static_cast<int>(t)),
                      adjusted_.stiffness_scale())) {
      double& depth_m = by_node[dent.node];
      depth_m = std::max(depth_m, dent.depth_m);
    }
  }
  std::vector<NodeDent> all;
  for (const auto& [node, depth_m] : by_node) {
    all.push_back({node, depth_m});
  }
  return all;
}

ViewFrame ContactSession::frame() {
  return {.holding = holding(),
          .hand_m = hands_.front().pointer.target().position_m,
          .pointer_m = hands_.front().pointer.pointer_m(),
          .fault = name(fault()),
          .net_j = account().work_j,
          .now = latest_,
          .dents = dents(),
          .hands = hands(),
          .run = run_,
          .settings = {.model = LocalModel::kPotential,
                       .slow_hz = options_.slow_hz,
                       .fast_hz = options_.fast_hz,
                       .stiffness_scale = adjusted_.stiffness_scale(),
                       .friction = adjusted_.friction()}};
}

}  // namespace palpate
