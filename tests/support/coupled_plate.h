// Plates of contact spheres on a wavy body, and the account of a walk over it.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "runtime/contacts/coupled_step.h"
#include "runtime/slow/coupled_storage.h"
#include "tests/bench/runtime/contact_walk.h"
#include "tests/support/tick.h"

namespace palpate {

inline constexpr double kRadiusM = 0.003;

inline FastConfig free_of_clamps() {
  FastConfig config;
  config.model = LocalModel::kPotential;
  config.force_max_n = 1e9;
  config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  return config;
}

inline BenchBodyOptions rough(double friction = 0.0) {
  return {.wave_m = 0.002,
          .contrast = 9.0,
          .tilt_rad = 0.1,
          .friction_min = friction,
          .friction_max = friction,
          .touch_offset_m = 1e-4};
}

inline void send_all(CoupledState& state, const ContactBody& body,
                     const PortPoses& pose) {
  for (int i = 0; i < state.set.count; ++i) {
    send(state, body, pose, i);
  }
}

inline PortPose moved_by(const PortPose& pose, int axis, double h) {
  PortPose to = pose;
  if (axis < 3) {
    to.position_m(axis) += h;
  } else {
    to.rotation =
        Eigen::AngleAxisd(h, Eigen::Vector3d::Unit(axis - 3)).toRotationMatrix() *
        pose.rotation;
  }
  return to;
}

// The wrench against the potential's differences along six axes of every port.
inline void expect_gradient(CoupledState& state, const PortPoses& pose,
                            const WrenchCommand& command, double lever_m) {
  const auto moved = std::make_unique<CoupledModel>();
  for (int port = 0; port < state.set.ports; ++port) {
    const auto p = static_cast<std::size_t>(port);
    const Wrench& wrench = command.wrench[p];
    for (int axis = 0; axis < 6; ++axis) {
      const double h = 3e-8 / (axis < 3 ? 1.0 : lever_m);
      PortPoses above = pose;
      PortPoses below = pose;
      above[p] = moved_by(pose[p], axis, h);
      below[p] = moved_by(pose[p], axis, -h);
      const double slope =
          (potential_j(state, *moved, above) - potential_j(state, *moved, below)) /
          (2.0 * h);
      const double given =
          axis < 3 ? wrench.force_n(axis) : wrench.torque_n_m(axis - 3);
      const double scale = wrench.force_n.norm() * (axis < 3 ? 1.0 : lever_m);
      // Of second order in h, which a shallow contact shows, and energies to 1e-16 J.
      EXPECT_NEAR(given, -slope, 1e-6 * scale + 1e-9) << port << " axis " << axis;
    }
  }
}

// Work of a model on its way, kept by the test.
struct CoupledAccount {
  std::unique_ptr<CoupledModel> moved = std::make_unique<CoupledModel>();
  double net_j = 0.0;
  double lowest_j = 0.0;

  WrenchCommand step(CoupledState& state, const PortPoses& pose, double dt_s = kTickS) {
    relax_ahead(state, dt_s);
    net_j += potential_j(state, *moved, pose) - state.ledger.stored_j;
    lowest_j = std::min(lowest_j, net_j);
    return palpate::step(state, {pose, 0}, dt_s);
  }
};

// Comes down on the pose from free space.
inline WrenchCommand press(CoupledState& state, const ContactBody& body,
                           PortPoses pose) {
  send_all(state, body, pose);
  const double height = pose[0].position_m.z();
  WrenchCommand command;
  for (int tick = 200; tick >= 0; --tick) {
    pose[0].position_m.z() = height + 2e-5 * tick;
    command = step(state, {pose, 0}, kTickS);
  }
  return command;
}

}  // namespace palpate
