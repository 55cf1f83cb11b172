// One tick for all tools, a body that stands somewhere in the world, its surface and
// its forces at rest, through palpate.h.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/support/padded_host.h"
#include "tests/support/run_tool.h"

namespace palpate {
namespace {

using Wrenches = std::array<palpate_hand_wrench, 2>;

class PalpateStep : public PaddedHost {
 protected:
  palpate_body* open_body(const palpate_options& options) {
    palpate_close(body_);
    body_ = palpate_open(file_.c_str(), &options, error_, sizeof error_);
    EXPECT_NE(body_, nullptr) << error_;
    return body_;
  }

  // Two hands 14 mm apart go down a centimetre, the second turned; of one the first.
  static std::array<palpate_pose, 2> poses_at(int tick) {
    const double z = 0.003 + 1e-5 * (1000 - tick);
    return {{{{-0.006, 0.002, z}, {0.0, 0.02, 0.0, 1.0}},
             {{0.008, 0.002, z}, {0.0, 0.0, 0.01, 1.0}}}};
  }

  // @param world where the body stands: poses go there, wrenches come back.
  Wrenches press(palpate_tool* tool, std::size_t hands,
                 const Eigen::Isometry3d& world = Eigen::Isometry3d::Identity()) {
    Wrenches out{};
    for (int tick = 0; tick <= 1000; ++tick) {
      auto poses = poses_at(tick);
      for (palpate_pose& pose : poses) {
        Eigen::Map<Eigen::Vector3d> at(pose.position);
        Eigen::Map<Eigen::Vector4d> turn(pose.quat_xyzw);
        at = (world * Eigen::Vector3d(at)).eval();
        turn = (Eigen::Quaterniond(world.rotation()) *
                Eigen::Quaterniond(Eigen::Vector4d(turn)))
                   .coeffs();
      }
      status_ = palpate_step(tool, poses.data(), hands, 0.001, out.data());
      if (tick % 10 == 0) {
        EXPECT_GE(palpate_slow_step(body_), 0);
      }
    }
    for (palpate_hand_wrench& wrench : out) {
      Eigen::Map<Eigen::Vector3d> force(wrench.force), torque(wrench.torque);
      force = (world.rotation().transpose() * force).eval();
      torque = (world.rotation().transpose() * torque).eval();
    }
    return out;
  }

  static void expect_near(const double (&a)[3], const double (&b)[3], double within) {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(a[i], b[i], within) << i;
    }
  }

  int status_ = 0;
};

TEST_F(PalpateStep, IsTheTickOfWhichTheOldFunctionsAreForms) {
  for (const char* tool : {"ball", "pads"}) {
    open_body(options(tool));
    const Wrenches all = press(palpate_tool_add(body_), 1);
    EXPECT_EQ(status_, PALPATE_CONTACT);
    palpate_tool* same = palpate_tool_add(body_);
    double force[3] = {}, torque[3] = {};
    for (int tick = 0; tick <= 1000; ++tick) {
      const auto poses = poses_at(tick);
      (void)palpate_wrench(same, poses[0].position, poses[0].quat_xyzw, 0.001, force,
                           torque);
      if (tick % 10 == 0) {
        EXPECT_GE(palpate_slow_step(body_), 0);
      }
    }
    EXPECT_GT(force[2], 0.01);
    expect_near(all[0].force, force, 0.0);
    expect_near(all[0].torque, torque, 0.0);
  }
  open_body(options("ball"));
  palpate_tool* pinch = palpate_together_open(body_, "pads", error_, sizeof error_);
  ASSERT_NE(pinch, nullptr) << error_;
  const Wrenches both = press(pinch, 2);
  palpate_state state{};
  state.struct_size = sizeof state;
  palpate_state_get(pinch, &state);
  expect_near(both[0].force, state.force, 0.0);
  expect_near(both[1].force, state.second_force, 0.0);
  expect_near(both[1].torque, state.second_torque, 0.0);
  EXPECT_GT(both[1].force[2], both[0].force[2]);
}

// A simulator may turn its tool in one tick by more than any wrist does.
TEST_F(PalpateStep, FollowsATurnThatNoWristMakes) {
  open_body(options("pads"));
  palpate_tool* tool = palpate_tool_add(body_);
  palpate_pose pose{{0.001, 0.002, 0.02}, {0.0, 0.0, 0.0, 1.0}};
  palpate_hand_wrench out{};
  EXPECT_EQ(palpate_step(tool, &pose, 1, 0.001, &out), PALPATE_FREE);
  pose.quat_xyzw[2] = 1.0;  // a quarter about z
  EXPECT_EQ(palpate_step(tool, &pose, 1, 0.001, &out), PALPATE_FREE);
}

TEST_F(PalpateStep, TakesAPoseOfEachHandAndNoOther) {
  open_body(options("ball"));
  palpate_tool* one = palpate_tool_add(body_);
  palpate_tool* two = palpate_together_open(body_, nullptr, error_, sizeof error_);
  const auto poses = poses_at(0);
  Wrenches out{};
  out[0].force[0] = 1.0;
  EXPECT_EQ(palpate_step(one, poses.data(), 2, 0.001, out.data()), PALPATE_ERROR_INPUT);
  EXPECT_EQ(out[0].force[0], 0.0);
  EXPECT_EQ(palpate_step(two, poses.data(), 1, 0.001, out.data()), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_step(one, nullptr, 1, 0.001, out.data()), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_step(nullptr, poses.data(), 1, 0.001, out.data()),
            PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_step(one, poses.data(), 1, 0.001, nullptr), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_step(one, poses.data(), 1, 0.001, out.data()), PALPATE_FREE);
}

// A flag of the body's says that nobody feels the torque: it is none, and the force is
// palpate_force()'s.
TEST_F(PalpateStep, WithoutTorqueTheToolTurnsAtNoGain) {
  palpate_options alone = options("pads");
  alone.flags |= PALPATE_FORCES_ALONE;
  open_body(alone);
  const Wrenches out = press(palpate_tool_add(body_), 1);
  const double none[3] = {};
  expect_near(out[0].torque, none, 0.0);
  palpate_tool* same = palpate_tool_add(body_);
  double force[3] = {};
  for (int tick = 0; tick <= 1000; ++tick) {
    const auto poses = poses_at(tick);
    (void)palpate_force(same, poses[0].position, poses[0].quat_xyzw, 0.001, force);
    if (tick % 10 == 0) {
      EXPECT_GE(palpate_slow_step(body_), 0);
    }
  }
  expect_near(out[0].force, force, 0.0);
}

Eigen::Isometry3d somewhere() {
  Eigen::Isometry3d world = Eigen::Isometry3d::Identity();
  world.translate(Eigen::Vector3d(0.3, -1.2, 0.7));
  world.rotate(Eigen::AngleAxisd(2.0, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()));
  return world;
}

// The same press of a body that stands elsewhere, turned, is felt the same.
TEST_F(PalpateStep, ABodyThatStandsInTheWorldIsFeltThere) {
  const Eigen::Isometry3d world = somewhere();
  const Eigen::Quaterniond turn(world.rotation());
  for (const bool hands : {false, true}) {
    open_body(options("pads"));
    const auto add = [&] {
      return hands ? palpate_together_open(body_, "ball", error_, sizeof error_)
                   : palpate_tool_add(body_);
    };
    const Wrenches here = press(add(), hands ? 2 : 1);
    ASSERT_EQ(palpate_place(body_, world.translation().data(), turn.coeffs().data()),
              0);
    palpate_tool* tool = add();
    const Wrenches there = press(tool, hands ? 2 : 1, world);
    for (std::size_t hand = 0; hand < (hands ? 2U : 1U); ++hand) {
      EXPECT_GT(here[hand].force[2], 0.01);
      expect_near(there[hand].force, here[hand].force, 1e-9);
      expect_near(there[hand].torque, here[hand].torque, 1e-11);
    }
    palpate_state state{};
    state.struct_size = sizeof state;
    palpate_state_get(tool, &state);
    const Eigen::Vector3d up = world.rotation() * Eigen::Vector3d::UnitZ();
    EXPECT_NEAR(Eigen::Map<Eigen::Vector3d>(state.normal).dot(up), 1.0, 1e-6);
    const Eigen::Vector3d point =
        world.inverse() * Eigen::Map<Eigen::Vector3d>(state.contact_point);
    EXPECT_NEAR(point.z(), 0.0, 1e-9);
    EXPECT_NEAR(state.work_j,
                state.stored_j + state.tank_j + state.dissipated_j + state.memory_j,
                1e-12);
    // What the device made of it is told in the world, too.
    palpate_hand_wrench made[2] = {};
    EXPECT_EQ(palpate_delivered(tool, made[0].force, nullptr), 0);
  }
}

// examples/placed.c draws and presses a plate that lies flat, and stands turned.
TEST_F(PalpateStep, AHostOfFortyLinesPressesATurnedBody) {
  for (const char* turn : {"0", "0.4"}) {
    const ToolRun run =
        run_tool_process("c_placed_host", {file_, "ball", "0.005", turn});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.out.find("contact"), 0U) << run.out;
  }
}

TEST_F(PalpateStep, APlaceThatIsNoneIsRefused) {
  open_body(options("ball"));
  const double at[3] = {0.0, 0.0, 1.0}, nan[3] = {0.0, std::nan(""), 0.0};
  const double none[4] = {}, endless[4] = {0.0, 0.0, HUGE_VAL, 1.0};
  EXPECT_EQ(palpate_place(body_, nan, nullptr), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_place(body_, at, none), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_place(body_, at, endless), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_place(body_, nullptr, nullptr), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_place(nullptr, at, nullptr), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_place(body_, at, nullptr), 0);
}

TEST_F(PalpateStep, ItsSurfaceIsThereToBeDrawn) {
  palpate_options all = options("ball");
  all.metres_per_unit = 0.001;
  open_body(all);
  std::size_t vertices = 0, triangles = 0;
  ASSERT_EQ(palpate_mesh_count(body_, &vertices, &triangles), 0);
  EXPECT_EQ(vertices, 21U * 21U);
  EXPECT_EQ(triangles, 2U * 20U * 20U);
  const Eigen::Isometry3d world = somewhere();
  const Eigen::Vector3d origin = 1e3 * world.translation();
  ASSERT_EQ(palpate_place(body_, origin.data(),
                          Eigen::Quaterniond(world.rotation()).coeffs().data()),
            0);
  std::vector<double> x(3 * vertices);
  std::vector<std::int32_t> t(3 * triangles);
  ASSERT_EQ(palpate_mesh_get(body_, x.data(), t.data()), 0);
  double area = 0.0;
  const Eigen::Vector3d up = world.rotation() * Eigen::Vector3d::UnitZ();
  for (std::size_t i = 0; i < triangles; ++i) {
    const auto corner = [&](std::size_t c) {
      return Eigen::Map<const Eigen::Vector3d>(
          &x[3 * static_cast<std::size_t>(t[3 * i + c])]);
    };
    area += 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).dot(up);
  }
  EXPECT_NEAR(area, 1e4, 1e-6);  // mm^2, seen from above
  EXPECT_EQ(palpate_mesh_count(nullptr, &vertices, &triangles), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_mesh_get(body_, nullptr, nullptr), 0);
}

// f = 2e4 d^2 of a plate, at any number of places at once, without a tick.
TEST_F(PalpateStep, ForcesAtRestNeedNoTool) {
  palpate_options all = options("ball");
  all.newtons_per_unit = 0.001;
  open_body(all);
  const Eigen::Isometry3d world = somewhere();
  ASSERT_EQ(palpate_place(body_, world.translation().data(),
                          Eigen::Quaterniond(world.rotation()).coeffs().data()),
            0);
  constexpr std::size_t kPlaces = 50;
  std::vector<double> at(3 * kPlaces), force(3 * kPlaces);
  for (std::size_t i = 0; i < kPlaces; ++i) {
    const double depth = 1e-4 * (static_cast<double>(i) - 10.0);
    Eigen::Map<Eigen::Vector3d> place(&at[3 * i]);
    place = world * Eigen::Vector3d(0.0007 * static_cast<double>(i) - 0.02, 0.003,
                                    kPadRadius - depth);
  }
  ASSERT_EQ(
      palpate_query(body_, at.data(), kPlaces, force.data(), error_, sizeof error_), 0)
      << error_;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    const double depth = 1e-4 * (static_cast<double>(i) - 10.0);
    const Eigen::Vector3d f =
        world.rotation().transpose() * Eigen::Map<Eigen::Vector3d>(&force[3 * i]);
    EXPECT_NEAR(f.z(), depth > 0.0 ? 1e3 * 2e4 * depth * depth : 0.0, 0.2) << i;
    EXPECT_NEAR(f.head<2>().norm(), 0.0, 1e-3) << i;
  }
  open_body(options("pads"));
  EXPECT_EQ(palpate_query(body_, at.data(), 1, force.data(), error_, sizeof error_),
            PALPATE_ERROR_INPUT);
  EXPECT_NE(std::string(error_).find("one contact"), std::string::npos) << error_;
}

TEST(PalpateOptions, InitIsEveryDefault) {
  palpate_options all;
  palpate_options_init(&all);
  palpate_options zeros{};
  zeros.struct_size = sizeof zeros;
  EXPECT_EQ(std::memcmp(&all, &zeros, sizeof all), 0);
}

}  // namespace
}  // namespace palpate
