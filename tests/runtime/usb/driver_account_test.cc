// What motors cannot render is in the account: over a long walk through poses where the
// Falcon's and the Haply's motors saturate or have no transmission, no hand gets more
// than it put in, the energy floor, and what sampling adds.
//
// Walks 10^5 ticks, or PALPATE_WALK_TICKS (build/release/bin/runtime_usb_tests
// --gtest_filter='DriverAccount*').
#include <array>
#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"
#include "runtime/fast/fast_step.h"
#include "runtime/usb/falcon_geometry.h"
#include "runtime/usb/falcon_motors.h"
#include "runtime/usb/haply_packet.h"
#include "runtime/usb/pantograph.h"
#include "tests/support/walk_ticks.h"

namespace palpate {
namespace {

constexpr double kTickS = 1e-3;

// Force on the tool that a device makes of a command, in the device's frame.
using Motors = Eigen::Vector3d (*)(const Eigen::Vector3d& device_m,
                                   const Eigen::Vector3d& force_n);

Eigen::Vector3d falcon(const Eigen::Vector3d& device_m,
                       const Eigen::Vector3d& force_n) {
  FalconPose pose;
  if (!inverse(device_m, pose)) {
    return Eigen::Vector3d::Zero();
  }
  const FalconMotors motors = motors_for(force_n, pose.rates, 1.0);
  return force_of(motors.command, pose.rates, 1.0);
}

Eigen::Vector3d haply(const Eigen::Vector3d& device_m, const Eigen::Vector3d& force_n) {
  PantographPose pose;
  Eigen::Vector2d theta;
  Eigen::Vector3d sent = Eigen::Vector3d::Zero();
  if (inverse(PantographLinks{}, device_m.head<2>(), theta) &&
      forward(PantographLinks{}, theta, pose)) {
    sent.head<2>() =
        force_of(pose, torques_for(pose, force_n.head<2>(), kHaplyTorqueMaxNm));
  }
  return sent;
}

struct Walk {
  double worst_j = 0.0;      // most that the hand got beyond what it may
  double clamped_n = 0.0;    // largest force that did not leave
  std::int64_t clamped = 0;  // ticks on which some did not
  std::int64_t contacts = 0;
  std::int64_t faults = 0;
};

// A hand that presses in at one place, slides over the body and withdraws at another,
// at 0.1 m/s, again and again: where motors can do less at the first than at the
// second, it is given energy that it never put in.
class Presses {
 public:
  explicit Presses(double reach_m) : reach_m_(reach_m) { choose(); }

  // From the middle of the body's surface.
  Eigen::Vector3d next() {
    constexpr double kStepM = 1e-4;
    const Eigen::Vector3d way = goal_[at_] - x_;
    if (way.norm() <= kStepM) {
      x_ = goal_[at_];
      at_ = (at_ + 1) % goal_.size();
      if (at_ == 0) {
        choose();
      }
    } else {
      x_ += kStepM * way.normalized();
    }
    return x_;
  }

 private:
  void choose() {
    std::uniform_real_distribution<double> place(-reach_m_, reach_m_);
    std::uniform_real_distribution<double> depth(0.002, 0.007);
    const Eigen::Vector3d in(place(random_), place(random_), 0.0);
    const Eigen::Vector3d out(place(random_), place(random_), 0.0);
    const Eigen::Vector3d up(0.0, 0.0, 0.002);
    const Eigen::Vector3d down(0.0, 0.0, -depth(random_));
    goal_ = {in + up, in + down, out + down, out + up};
  }

  double reach_m_;
  std::mt19937 random_{5};
  std::array<Eigen::Vector3d, 4> goal_;
  std::size_t at_ = 0;
  Eigen::Vector3d x_{0.0, 0.0, 0.002};
};

// A body of 12 cm under the middle of the device's workspace; its z axis is the
// device's y.
Walk walk(Motors motors, const Eigen::Matrix3d& to_device,
          const Eigen::Vector3d& centre_m, double floor_j, bool told) {
  const BenchBody body =
      make_bench_body({.cell_m = 0.01, .exponent = 1.5, .force_n = 20.0});
  const Eigen::Vector3d middle(0.06, 0.06, 0.0);
  auto state = std::make_unique<FastState>();
  state->config.force_max_n = 100.0;  // what clamps is the driver
  state->config.energy_floor_j = floor_j;
  Presses hand(0.05);
  Eigen::Vector3d x = middle + Eigen::Vector3d(0.0, 0.0, 0.002);
  Eigen::Vector3d sent = Eigen::Vector3d::Zero();
  Eigen::Vector3d model = Eigen::Vector3d::Zero();
  Walk result;
  // What the hand has put in and may get back: never more than the model holds.
  double left_j = 0.0;
  for (std::int64_t n = 0; n < walk_ticks(100'000); ++n) {
    const Eigen::Vector3d to = middle + hand.next();
    const Eigen::Vector3d moved = to - x;
    const double change_j = potential_j(*state, to) - potential_j(*state, x);
    x = to;
    // What sampling adds: the held force against the potential's change.
    const double sampling_j = change_j + model.dot(moved);
    left_j += -sent.dot(moved) + sampling_j;
    if (n % 10 == 0) {
      for (const Element& element : body.around(x)) {
        accept(*state, element);
      }
    }
    const FastCommand command = step(*state, {x, n}, kTickS);
    left_j = std::min(left_j, command.stored_j + command.tank_j);
    if (command.fault != 0) {  // the account has had enough: begin anew
      ++result.faults;
      const FastConfig config = state->config;
      state = std::make_unique<FastState>();
      state->config = config;
      left_j = 0.0;
      sent = model = Eigen::Vector3d::Zero();
      continue;
    }
    result.worst_j = std::max(result.worst_j, -left_j);
    const Eigen::Vector3d device = centre_m + to_device * (x - middle);
    sent = to_device.transpose() * motors(device, to_device * command.force_n);
    model = state->safety.model_n;
    const double withheld_n = (command.force_n - sent).norm();
    result.contacts += command.in_contact ? 1 : 0;
    result.clamped += withheld_n > 1e-2 ? 1 : 0;
    result.clamped_n = std::max(result.clamped_n, withheld_n);
    if (told) {
      delivered(*state, sent);
    }
  }
  return result;
}

Eigen::Matrix3d columns(const Eigen::Vector3d& x, const Eigen::Vector3d& y,
                        const Eigen::Vector3d& z) {
  Eigen::Matrix3d axes;
  axes << x, y, z;
  return axes;
}

void expect_bounded(const Walk& told, const Walk& untold, double floor_j) {
  EXPECT_GT(told.contacts, walk_ticks(100'000) / 10);
  EXPECT_GT(told.clamped, walk_ticks(100'000) / 1000);
  EXPECT_GT(told.clamped_n, 1.0);
  EXPECT_LE(told.worst_j, floor_j);
  EXPECT_GT(told.faults, 0);
  EXPECT_EQ(untold.faults, 0);
  // Without being told the account misses it: the walk can tell the two apart.
  EXPECT_GT(untold.worst_j, floor_j);
}

TEST(DriverAccount, HoldsWhereAFalconsMotorsSaturate) {
  // The body's z is the device's y; the workspace's edge is 6 cm from its middle.
  const Eigen::Matrix3d axes = columns(
      Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY());
  constexpr double kFloorJ = 0.01;
  expect_bounded(walk(falcon, axes, falcon_centre_m(), kFloorJ, true),
                 walk(falcon, axes, falcon_centre_m(), kFloorJ, false), kFloorJ);
}

TEST(DriverAccount, HoldsWhereAHaplyHasNoTransmission) {
  // Out of the plane nothing is rendered at all.
  const Eigen::Matrix3d axes = columns(
      Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY());
  const Eigen::Vector3d middle(0.0, 0.09, 0.0);
  constexpr double kFloorJ = 0.001;  // its motors are weak
  expect_bounded(walk(haply, axes, middle, kFloorJ, true),
                 walk(haply, axes, middle, kFloorJ, false), kFloorJ);
}

}  // namespace
}  // namespace palpate
