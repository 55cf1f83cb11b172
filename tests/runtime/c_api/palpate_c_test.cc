// The C interface as hosts see it: every call through palpate.h.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/database/table_memory.h"
#include "tests/runtime/c_api/host_standins.h"
#include "tests/runtime/c_api/pressed_plate_host.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/run_tool.h"

// The examples follow what they are examples for.
#include "runtime/c_api/examples/chai3d_effect.h"
#include "runtime/c_api/examples/sofa_feedback.h"

namespace palpate {
namespace {

class PalpateC : public PressedPlateHost {};

TEST_F(PalpateC, PressRendersTheStoredCurve) {
  palpate_tool* tool = open(options());
  ASSERT_NE(tool, nullptr) << error_;
  const Answer answer = press(tool, 0.003);
  EXPECT_EQ(answer.status, PALPATE_CONTACT);
  // int16 storage of a curve of 41 samples: a cubic through a parabola, 1e-4 of 8 N.
  EXPECT_NEAR(answer.force[2], wall(0, 0.003), 1e-3);
  palpate_state state{};
  state.struct_size = sizeof state;
  palpate_state_get(tool, &state);
  EXPECT_EQ(state.status, PALPATE_CONTACT);
  EXPECT_EQ(state.ticks, 900U);
  EXPECT_NEAR(state.depth, 0.003, 1e-12);
  EXPECT_NEAR(state.contact_point[0], 0.0031, 1e-12);
  EXPECT_NEAR(state.contact_point[2], 0.0, 1e-12);
  EXPECT_NEAR(state.normal[2], 1.0, 1e-12);
  EXPECT_EQ(state.force[2], answer.force[2]);
  EXPECT_NEAR(state.work_j, state.stored_j + state.tank_j + state.dissipated_j, 1e-15);
}

TEST_F(PalpateC, PassiveModelsRenderTheStoredCurveAndOthersAreRefused) {
  palpate_options all = options();
  for (const char* model : {"potential", "element", "energy-tank"}) {
    all.model = model;
    EXPECT_NEAR(press(open(all), 0.003).force[2], wall(0, 0.003), 1e-3) << error_;
  }
  for (const char* model : {"single", "first-order-hold", "none", ""}) {
    all.model = model;
    EXPECT_TRUE(open(all) == nullptr && std::strstr(error_, "equal-energy")) << model;
  }
}

TEST_F(PalpateC, FreeSpaceIsZeroForce) {
  palpate_tool* tool = open(options());
  const Answer answer = press(tool, -0.0005);
  EXPECT_EQ(answer.status, PALPATE_FREE);
  EXPECT_EQ(answer.force, (std::array<double, 3>{}));
}

TEST_F(PalpateC, HostUnitsScaleLengthAndForce) {
  palpate_options wanted = options();
  wanted.metres_per_unit = 0.001;
  wanted.newtons_per_unit = 0.01;
  palpate_tool* plain = open(options());
  const Answer metres = press(plain, 0.003);
  palpate_tool* tool = open(wanted);
  Answer answer;
  for (int tick = 0; tick < 900; ++tick) {
    const double depth_mm = -1.0 + 4.0 * std::min(1.0, tick / 400.0);
    const double at[3] = {3.1, 1.7, 5.0 - depth_mm};
    answer.status = palpate_force(tool, at, nullptr, 0.001, answer.force.data());
    if (tick % 10 == 0) {
      ASSERT_GE(palpate_slow_step(body_), 0);
    }
  }
  // Rounding of millimetres: 1e-16 m at slopes of 120 N/m, and what adds up on the way.
  EXPECT_NEAR(answer.force[2] * 0.01, metres.force[2], 1e-12);
  palpate_state state{};
  state.struct_size = sizeof state;
  palpate_state_get(tool, &state);
  EXPECT_NEAR(state.depth, 3.0, 1e-9);
}

TEST_F(PalpateC, ZeroTimeMeansTheNominalTick) {
  palpate_tool* tool = open(options());
  const Answer named = press(tool, 0.002);
  tool = open(options());
  Answer answer;
  for (int tick = 0; tick < 900; ++tick) {
    answer = force(tool, -0.001 + 0.003 * std::min(1.0, tick / 400.0), 0.0);
    if (tick % 10 == 0) {
      ASSERT_GE(palpate_slow_step(body_), 0);
    }
  }
  EXPECT_EQ(answer.force, named.force);
}

TEST_F(PalpateC, NanIsZeroForceAndALatchedFaultUntilReset) {
  palpate_tool* tool = open(options());
  ASSERT_EQ(press(tool, 0.003).status, PALPATE_CONTACT);
  EXPECT_EQ(force(tool, kNan).status, PALPATE_FAULT_NOT_FINITE);
  const Answer after = force(tool, 0.003);
  EXPECT_EQ(after.status, PALPATE_FAULT_NOT_FINITE);
  EXPECT_EQ(after.force, (std::array<double, 3>{}));
  EXPECT_STREQ(palpate_fault_name(after.status), "not-finite");
  palpate_reset(tool);
  EXPECT_EQ(press(tool, 0.003).status, PALPATE_CONTACT);
}

// The plate of a material half of whose force relaxes, most of it in 0.1 s.
TEST_F(PalpateC, AHeldForceRelaxesAndAResetForgetsTheDent) {
  ResponseDatabase database = read_database(file_);
  Viscoelasticity relaxation;
  relaxation.instantaneous = true;
  relaxation.tau_s = {0.05, 2.0};
  relaxation.g = RowsOf<float>{{0.4F, 0.1F}};
  give_memory(database.body, database.normal, relaxation, 1, database.tools[0]);
  write_database(file_, database);
  palpate_tool* tool = open(options());
  ASSERT_NE(tool, nullptr) << error_;
  const auto state_of = [&] {
    palpate_state state{};
    state.struct_size = sizeof state;
    palpate_state_get(tool, &state);
    return state;
  };
  const double held_n = press(tool, 0.003).force[2];
  const double whole_n = 0.18;
  EXPECT_GT(held_n, 0.5 * whole_n);
  EXPECT_LT(held_n, 0.6 * whole_n);
  palpate_state state = state_of();
  EXPECT_NEAR(state.relaxed_force, whole_n - held_n, 0.01 * whole_n);
  EXPECT_GT(state.memory_j, 0.0);
  EXPECT_NEAR(state.work_j,
              state.stored_j + state.tank_j + state.dissipated_j + state.memory_j,
              1e-12);
  // Its dent is there when the tool comes back at once, and gone after a reset.
  for (int tick = 0; tick < 5; ++tick) {
    force(tool, -0.001);
  }
  EXPECT_LT(force(tool, 0.001).force[2], 0.1 * 2e4 * 1e-6);
  palpate_reset(tool);
  EXPECT_EQ(state_of().memory_j, 0.0);
  for (int tick = 0; tick < 200; ++tick) {
    force(tool, -0.001);
    palpate_slow_step(body_);
  }
  EXPECT_GT(force(tool, 0.001).force[2], 0.9 * 2e4 * 1e-6);
}

// The plate of a material that keeps dents and softens.
TEST_F(PalpateC, WhatHasYieldedOutlivesAResetAndTheProcess) {
  ResponseDatabase database = read_database(file_);
  Viscoelasticity yields;
  yields.yielding = {.yield_depth_m = {0.001},
                     .share = {0.4},
                     .onset_m = {0.001},
                     .scale_m = {0.002},
                     .largest = {0.5}};
  give_memory(database.body, database.normal, yields, 1, database.tools[0]);
  write_database(file_, database);
  palpate_tool* tool = open(options());
  ASSERT_NE(tool, nullptr) << error_;
  const double first_n = press(tool, 0.003).force[2];
  EXPECT_NEAR(first_n, 0.18, 1e-6);
  palpate_state state{};
  state.struct_size = sizeof state;
  palpate_state_get(tool, &state);
  EXPECT_NEAR(state.dent, 0.4 * 0.002, 1e-12);
  EXPECT_GT(state.yielded_j, 0.0);
  EXPECT_NEAR(state.work_j, state.stored_j + state.tank_j + state.dissipated_j, 1e-12);
  const std::string surface = (folder_ / "surface.h5").string();
  ASSERT_EQ(palpate_surface_save(tool, surface.c_str(), error_, sizeof error_), 0)
      << error_;
  palpate_reset(tool);
  const double again_n = press(tool, 0.002).force[2];
  EXPECT_LT(again_n, 0.8 * 2e4 * 0.002 * 0.002);
  EXPECT_GT(again_n, 0.0);
  // A fresh body, and the worn one again, in another process's words.
  EXPECT_EQ(palpate_surface_load(tool, nullptr, error_, sizeof error_), 0);
  EXPECT_NEAR(press(tool, 0.002).force[2], 2e4 * 0.002 * 0.002, 1e-6);
  tool = open(options());
  EXPECT_EQ(palpate_surface_load(tool, surface.c_str(), error_, sizeof error_), 0)
      << error_;
  EXPECT_EQ(press(tool, 0.002).force[2], again_n);
  // Another body's is refused, and nothing changes.
  database.provenance.left_out = "something";
  write_database(file_, database);
  tool = open(options());
  EXPECT_EQ(palpate_surface_load(tool, surface.c_str(), error_, sizeof error_),
            PALPATE_ERROR_INPUT);
  EXPECT_NE(std::string(error_).find("the surface of another body"), std::string::npos);
  EXPECT_EQ(palpate_surface_save(tool, surface.c_str(), error_, sizeof error_),
            PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_surface_load(nullptr, nullptr, nullptr, 0), PALPATE_ERROR_INPUT);
}

TEST_F(PalpateC, EveryBadInputHasItsFault) {
  const double at[3] = {0.0031, 0.0017, 0.01};
  double out[3];
  for (const double dt_s : {-1e-3, 1.5, kNan}) {
    palpate_tool* tool = open(options());
    EXPECT_EQ(palpate_force(tool, at, nullptr, dt_s, out), PALPATE_FAULT_TIME_STEP);
  }
  palpate_tool* tool = open(options());
  const double turned[4] = {0.0, kNan, 0.0, 1.0};
  EXPECT_EQ(palpate_force(tool, at, turned, 0.001, out), PALPATE_FAULT_NOT_FINITE);
  EXPECT_EQ(palpate_force(nullptr, at, nullptr, 0.001, out), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_force(tool, nullptr, nullptr, 0.001, out), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_force(tool, at, nullptr, 0.001, nullptr), PALPATE_ERROR_INPUT);
}

TEST_F(PalpateC, WithoutSlowStepsContactStalls) {
  palpate_tool* tool = open(options());
  ASSERT_EQ(press(tool, 0.003).status, PALPATE_CONTACT);
  int ticks = 0;
  while (force(tool, 0.003).status == PALPATE_CONTACT && ticks < 10000) {
    ++ticks;
  }
  EXPECT_EQ(force(tool, 0.003).status, PALPATE_FAULT_SLOW_STALLED);
  EXPECT_NEAR(ticks, 500, 12);  // 0.5 s, and a slow period
}

TEST_F(PalpateC, OrientationChangesTheTiltAlone) {
  palpate_tool* tool = open(options());
  const Answer before = press(tool, 0.003);
  const double at[3] = {0.0031, 0.0017, kRadius - 0.003};
  const double turned[4] = {0.2, 0.0, 0.0, 0.2};  // 90 degrees about x, not normalised
  double out[3];
  EXPECT_EQ(palpate_force(tool, at, turned, 0.001, out), PALPATE_CONTACT);
  // press() rounds its last depth in another way: 1e-18 m at 120 N/m.
  EXPECT_NEAR(out[2], before.force[2], 1e-15);
  palpate_state state{};
  state.struct_size = sizeof state;
  palpate_state_get(tool, &state);
  EXPECT_NEAR(state.tilt_rad, 1.5707963267948966, 1e-15);
}

TEST_F(PalpateC, ForceAllocatesNothing) {
  palpate_tool* tool = open(options());
  std::uint64_t allocations = 0;
  for (int tick = 0; tick < 900; ++tick) {
    const test::AllocationGuard guard;
    static_cast<void>(force(tool, -0.001 + 0.004 * std::min(1.0, tick / 400.0)));
    allocations += guard.count();
    if (tick % 10 == 0) {
      EXPECT_GE(palpate_slow_step(body_), 0);
    }
  }
  EXPECT_EQ(allocations, 0U);
}

TEST_F(PalpateC, StiffBodyIsRefusedOrScaledAtTheDevice) {
  palpate_options wanted = options();
  // The largest slope is 400 N/m at 10 mm, friction's 0.3 * 2 N / 0.5 mm = 1200 N/m.
  // A workspace scale of 2 doubles them; b / (T/2) = 2 * 0.6 / 0.001.
  wanted.device_damping_n_s_per_m = 0.6;
  EXPECT_NE(open(wanted), nullptr) << error_;
  wanted.position_gain = 2.0;
  EXPECT_EQ(open(wanted), nullptr);
  EXPECT_NE(std::string(error_).find("cannot render"), std::string::npos) << error_;
  wanted.flags |= PALPATE_LIMIT_STIFFNESS;
  palpate_tool* tool = open(wanted);
  ASSERT_NE(tool, nullptr) << error_;
  const Answer answer = press(tool, 0.003);
  palpate_state state{};
  state.struct_size = sizeof state;
  palpate_state_get(tool, &state);
  EXPECT_NEAR(state.force_scale, 0.5, 1e-3);
  EXPECT_NEAR(answer.force[2], state.force_scale * wall(0, 0.003), 1e-3);
}

TEST_F(PalpateC, ForceIsLimitedAtTheDevice) {
  palpate_options wanted = options();
  wanted.force_max_n = 0.2;
  wanted.force_gain = 4.0;
  palpate_tool* tool = open(wanted);
  EXPECT_NEAR(press(tool, 0.008).force[2], 0.05, 1e-12);
}

// K is friction's 1200 N/m here: 0.3 * 2 N / 0.5 mm.
TEST_F(PalpateC, StreamedDatabaseRendersTheSame) {
  const Answer whole = press(open(options()), 0.003);
  palpate_options wanted = options();
  wanted.flags |= PALPATE_STREAMED;
  palpate_tool* tool = open(wanted);
  ASSERT_NE(tool, nullptr) << error_;
  EXPECT_EQ(press(tool, 0.003).force, whole.force);
  EXPECT_EQ(palpate_slow_failure(body_, error_, sizeof error_), 0) << error_;
}

// The haptic thread runs ahead of the clock by less than the stall limit.
TEST_F(PalpateC, OwnSlowThreadServesTools) {
  palpate_options wanted = options();
  wanted.flags = 0;
  wanted.slow_hz = 1000.0;
  wanted.stall_s = 1e6;
  palpate_tool* tool = open(wanted);
  ASSERT_NE(tool, nullptr) << error_;
  EXPECT_EQ(palpate_slow_step(body_), PALPATE_ERROR_INPUT);
  Answer answer;
  for (int tick = 0; tick < 400 || (tick < 100000 && answer.force[2] < 0.1); ++tick) {
    answer = force(tool, -0.001 + 0.004 * std::min(1.0, tick / 400.0));
    palpate_state state{};
    state.struct_size = sizeof state;
    palpate_state_get(tool, &state);
    pause_between_ticks();
  }
  EXPECT_EQ(answer.status, PALPATE_CONTACT);
  EXPECT_EQ(palpate_slow_failure(body_, nullptr, 0), 0);
}

TEST_F(PalpateC, Chai3dEffectFeelsTheBodyWithEveryTool) {
  chai3d::cGenericObject object;
  PalpateEffect effect(&object, file_.c_str(), 1.0);
  chai3d::cVector3d position;
  chai3d::cVector3d force;
  const unsigned int last = 15;
  for (int tick = 0; tick < 100000 && force.z() < 0.1; ++tick) {
    position.set(0.0031, 0.0017, kRadius + 0.001 - 0.004 * std::min(1.0, tick / 400.0));
    static_cast<void>(effect.computeForce(position, {}, last, force));
    pause_between_ticks();
  }
  EXPECT_GT(force.z(), 0.1);
  EXPECT_FALSE(effect.computeForce(position, {}, 16, force));
  EXPECT_EQ(force.z(), 0.0);
}

TEST_F(PalpateC, SofaFeedbackTakesMillimetresAndNoOrientation) {
  PalpateForceFeedback feedback(file_, 0.001);
  feedback.init();
  double fx = 0.0;
  double fy = 0.0;
  double fz = 0.0;
  for (int tick = 0; tick < 100000 && fz < 0.1; ++tick) {
    const double z_mm = 6.0 - 4.0 * std::min(1.0, tick / 400.0);
    feedback.computeForce(3.1, 1.7, z_mm, 0.0, 0.0, 0.0, 0.0, fx, fy, fz);
    pause_between_ticks();
  }
  EXPECT_GT(fz, 0.1);
}

TEST_F(PalpateC, PlainCProgramPressesTheBody) {
  const ToolRun run =
      run_tool_process("c_host", {file_, "0.0031", "0.0017", "0.0", "0.005", "0.003"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  double x = 1.0;
  double y = 1.0;
  double z = 0.0;
  ASSERT_EQ(std::sscanf(run.out.c_str(), "contact %lg %lg %lg", &x, &y, &z), 3)
      << run.out;
  EXPECT_NEAR(z, wall(0, 0.003), 1e-3);
  const ToolRun absent = run_tool_process(
      "c_host", {file_ + "x", "0.0031", "0.0017", "0.0", "0.005", "0.003"});
  EXPECT_EQ(absent.exit_code, 1);
  EXPECT_NE(absent.err.find(file_ + "x"), std::string::npos);
}

}  // namespace
}  // namespace palpate
