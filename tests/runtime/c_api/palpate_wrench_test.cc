// Tools of several contacts through palpate.h.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "formats/database/table_memory.h"
#include "runtime/c_api/palpate_draw.h"
#include "tests/support/padded_host.h"
#include "tests/support/pause_between_ticks.h"
#include "tests/support/run_tool.h"

namespace palpate {
namespace {

using Triple = std::array<double, 3>;

struct WrenchAnswer {
  int status = 0;
  Triple force{};
  Triple torque{};
};

class PalpateWrench : public PaddedHost {
 protected:
  palpate_tool* open(const palpate_options& options) {
    palpate_close(body_);
    body_ = palpate_open(file_.c_str(), &options, error_, sizeof error_);
    return body_ == nullptr ? nullptr : palpate_tool_add(body_);
  }

  std::string refusal(const std::string& file, const palpate_options& options) {
    palpate_body* body = palpate_open(file.c_str(), &options, error_, sizeof error_);
    EXPECT_EQ(body, nullptr);
    palpate_close(body);
    return error_;
  }

  // Down onto z, turned about y by `turn`; lengths in units of `unit` metres.
  WrenchAnswer press(palpate_tool* tool, double z, double turn, double unit = 1.0) {
    const double quaternion[4] = {0.0, 3.0 * std::sin(0.5 * turn), 0.0,
                                  3.0 * std::cos(0.5 * turn)};
    WrenchAnswer answer;
    for (int tick = 0; tick <= 1000; ++tick) {
      const double at[3] = {0.001 / unit, 0.002 / unit,
                            (z + 1e-5 * (1000 - tick)) / unit};
      answer.status = palpate_wrench(tool, at, quaternion, 0.001, answer.force.data(),
                                     answer.torque.data());
      if (tick % 10 == 0) {
        EXPECT_GE(palpate_slow_step(body_), 0);
      }
    }
    return answer;
  }
};

TEST_F(PalpateWrench, ATurnedToolIsTurnedBack) {
  palpate_tool* tool = open(options("pads"));
  ASSERT_NE(tool, nullptr) << error_;
  const WrenchAnswer flat = press(tool, 0.003, 0.0);
  EXPECT_EQ(flat.status, PALPATE_CONTACT);
  EXPECT_GT(flat.force[2], 0.1);
  EXPECT_NEAR(flat.torque[1], 0.0, 1e-6);  // but for the triangles of the plate
  palpate_state state{};
  state.struct_size = sizeof state;
  palpate_state_get(tool, &state);
  EXPECT_EQ(state.contacts, 3);
  EXPECT_EQ(state.coupling_scaled, 0);
  EXPECT_EQ(state.torque[1], flat.torque[1]);
  EXPECT_NEAR(state.work_j, state.stored_j + state.tank_j + state.dissipated_j, 1e-12);
  palpate_reset(tool);
  // About y, +x goes down, and is pressed up there: a torque that turns it back.
  const WrenchAnswer turned = press(tool, 0.003, 0.05);
  EXPECT_EQ(turned.status, PALPATE_CONTACT);
  EXPECT_LT(turned.torque[1], -1e-4);
}

TEST_F(PalpateWrench, UnitsAreTheHosts) {
  const WrenchAnswer metres = press(open(options("pads")), 0.003, 0.05);
  palpate_options all = options("pads");
  all.metres_per_unit = 0.001;
  all.newtons_per_unit = 0.01;
  const WrenchAnswer other = press(open(all), 0.003, 0.05, 0.001);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(other.force[i], metres.force[i] * 100.0, 1e-8);
    EXPECT_NEAR(other.torque[i], metres.torque[i] * 1e5, 1e-5);
  }
}

TEST_F(PalpateWrench, OneContactIsPalpateForceWithoutTorque) {
  const WrenchAnswer wrench = press(open(options("ball")), 0.003, 0.3);
  palpate_tool* tool = open(options("ball"));
  Triple force{};
  for (int tick = 0; tick <= 1000; ++tick) {
    const double at[3] = {0.001, 0.002, 0.003 + 1e-5 * (1000 - tick)};
    (void)palpate_force(tool, at, nullptr, 0.001, force.data());
    if (tick % 10 == 0) {
      EXPECT_GE(palpate_slow_step(body_), 0);
    }
  }
  EXPECT_EQ(wrench.force, force);
  EXPECT_EQ(wrench.torque, (Triple{0.0, 0.0, 0.0}));
}

// Down upright, tilted there, up tilted, upright in the air: what the turned tool has
// more of must not come out by the force, where nobody feels the torque.
TEST_F(PalpateWrench, TurnsThatNobodyFeelsGiveTheHandNothing) {
  palpate_tool* tool = open(options("pads"));
  ASSERT_NE(tool, nullptr) << error_;
  constexpr int kQuarter = 200;
  const double k_n_per_m = palpate_needed_damping(body_) / 0.0005;
  Triple held{}, before{0.001, 0.002, 0.012};
  double put_in_j = 0.0, bound_j = 0.0, largest_n = 0.0;
  for (int tick = 0; tick < 10 * 4 * kQuarter; ++tick) {
    const double part = static_cast<double>(tick % kQuarter) / kQuarter;
    const int quarter = tick / kQuarter % 4;
    const double down = quarter == 0 ? part : quarter == 1 ? 1.0 : 3.0 - quarter - part;
    const double tilt = quarter == 0 ? 0.0 : quarter == 1 ? part : quarter == 2;
    const double back = quarter == 3 ? 1.0 - part : tilt;
    const double half = 0.15 * back;
    const Triple at{0.001, 0.002, 0.012 - 0.01 * std::max(0.0, down)};
    const double quaternion[4] = {0.0, std::sin(half), 0.0, std::cos(half)};
    for (std::size_t i = 0; i < 3; ++i) {
      const double dx = at[i] - before[i];
      put_in_j -= held[i] * dx;
      bound_j += 0.5 * k_n_per_m * dx * dx;
    }
    before = at;
    ASSERT_GE(palpate_force(tool, at.data(), quaternion, 0.001, held.data()), 0);
    largest_n = std::max(largest_n, held[2]);
    if (tick % 10 == 0) {
      ASSERT_GE(palpate_slow_step(body_), 0);
    }
  }
  EXPECT_GT(largest_n, 0.2);
  EXPECT_GE(put_in_j, -bound_j);
}

// Motors that give nothing on the way in, and all on the way out.
TEST_F(PalpateWrench, WhatAHostDoesNotDeliverIsInTheAccount) {
  for (const char* name : {"ball", "pads"}) {
    for (const bool told : {false, true}) {
      palpate_tool* tool = open(options(name));
      ASSERT_NE(tool, nullptr) << error_;
      int status = 0;
      WrenchAnswer answer;
      for (int tick = 0; tick < 40'000 && status >= 0; ++tick) {
        const double turn = 2e-3 * 3.14159265 * tick;
        const double at[3] = {0.001, 0.002, 0.003 + 0.003 * std::cos(turn)};
        status = palpate_wrench(tool, at, nullptr, 0.001, answer.force.data(),
                                answer.torque.data());
        const bool in = std::sin(turn) > 0.0;
        const Triple none{};
        if (told && in && status >= 0) {
          EXPECT_EQ(palpate_delivered(tool, none.data(), none.data()), 0);
        }
        if (tick % 10 == 0) {
          ASSERT_GE(palpate_slow_step(body_), 0);
        }
      }
      if (told) {
        EXPECT_EQ(status, PALPATE_FAULT_ENERGY) << name;
      } else {
        EXPECT_GE(status, 0) << name;
      }
    }
  }
}

TEST_F(PalpateWrench, AStreamedBodyAnswersAsOneInMemory) {
  palpate_options streamed = options("pads");
  streamed.flags |= PALPATE_STREAMED;
  const WrenchAnswer file = press(open(streamed), 0.003, 0.1);
  const WrenchAnswer memory = press(open(options("pads")), 0.003, 0.1);
  EXPECT_GT(memory.force[2], 0.1);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(file.force[k], memory.force[k], 1e-9);
    EXPECT_NEAR(file.torque[k], memory.torque[k], 1e-11);
  }
}

TEST_F(PalpateWrench, RefusesWithASentence) {
  EXPECT_NE(refusal(without_, options("pads")).find("has no table of compliance"),
            std::string::npos)
      << error_;
  palpate_options element = options("pads");
  element.model = "element";
  palpate_body* body = palpate_open(file_.c_str(), &element, error_, sizeof error_);
  EXPECT_EQ(body, nullptr);
  EXPECT_NE(std::string(error_).find("potential"), std::string::npos) << error_;
  palpate_close(body);
  palpate_options weak = options("pads");
  weak.device_damping_n_s_per_m = 0.01;
  EXPECT_NE(refusal(file_, weak).find("contacts together"), std::string::npos)
      << error_;
  weak.flags |= PALPATE_LIMIT_STIFFNESS;
  const WrenchAnswer limited = press(open(weak), 0.003, 0.0);
  const WrenchAnswer whole = press(open(options("pads")), 0.003, 0.0);
  EXPECT_GT(limited.force[2], 0.0);
  EXPECT_LT(limited.force[2], 0.9 * whole.force[2]);
}

// A host whose device moves a tenth as far feels arms ten times as long.
TEST_F(PalpateWrench, TurnsAreAsStiffAsTheDeviceFeelsThem) {
  const auto holds = [&](double position_gain, double force_gain,
                         double angular_n_m_s) {
    palpate_options all = options("pads");
    all.position_gain = position_gain;
    all.force_gain = force_gain;
    all.device_damping_n_s_per_m = 1e6;
    all.device_angular_damping_n_m_s = angular_n_m_s;
    return open(all) != nullptr;
  };
  double refused = 1e-7, needed = 1e-2;  // at gains of 1
  while (needed > 1.01 * refused) {
    const double middle = std::sqrt(refused * needed);
    (holds(1.0, 1.0, middle) ? needed : refused) = middle;
  }
  ASSERT_GT(refused, 1e-7);
  ASSERT_LT(needed, 1e-2);
  EXPECT_FALSE(holds(0.1, 1.0, 10.0 * 0.99 * refused));
  EXPECT_TRUE(holds(0.1, 1.0, 10.0 * 1.01 * needed));
  EXPECT_FALSE(holds(10.0, 3.0, 0.3 * 0.99 * refused));
  EXPECT_TRUE(holds(10.0, 3.0, 0.3 * 1.01 * needed));
}

TEST_F(PalpateWrench, WhatSeveralContactsLeaveOutlivesTheTool) {
  Viscoelasticity yields;
  yields.yielding.yield_depth_m = {0.0005};
  yields.yielding.share = {0.4};
  ResponseDatabase database = read_database(file_);
  for (ResponseTable& table : database.tools) {
    give_memory(database.body, database.normal, yields, 1, table);
  }
  write_database(file_, database);
  palpate_tool* tool = open(options("pads"));
  ASSERT_NE(tool, nullptr) << error_;
  const double first_n = press(tool, 0.003, 0.0).force[2];
  const std::string surface = file_ + ".surface";
  ASSERT_EQ(palpate_surface_save(tool, surface.c_str(), error_, sizeof error_), 0)
      << error_;
  palpate_reset(tool);
  const double again_n = press(tool, 0.0035, 0.0).force[2];
  EXPECT_LT(again_n, 0.8 * first_n);
  EXPECT_EQ(palpate_surface_load(tool, nullptr, error_, sizeof error_), 0) << error_;
  EXPECT_NEAR(press(tool, 0.003, 0.0).force[2], first_n, 1e-12);
  tool = open(options("pads"));
  EXPECT_EQ(palpate_surface_load(tool, surface.c_str(), error_, sizeof error_), 0)
      << error_;
  EXPECT_EQ(press(tool, 0.0035, 0.0).force[2], again_n);
}

// The library's own slow thread sends meanwhile.
TEST_F(PalpateWrench, AResetNeedsNoPauseOfTheSlowThread) {
  palpate_options all = options("pads");
  all.flags = 0;
  all.slow_hz = 1000.0;
  palpate_tool* tool = open(all);
  ASSERT_NE(tool, nullptr) << error_;
  for (int run = 0; run < 50; ++run) {
    palpate_contact first{};
    first.triangle = -1;
    for (int tick = 0; tick < 5000 && first.triangle < 0; ++tick) {
      const double at[3] = {0.001, 0.002, 0.006};
      Triple force{}, torque{};
      ASSERT_EQ(palpate_wrench(tool, at, nullptr, 0.0001, force.data(), torque.data()),
                PALPATE_FREE);
      ASSERT_EQ(palpate_contacts_get(tool, &first, 1, sizeof first), 3);
      pause_between_ticks();
    }
    EXPECT_GE(first.triangle, 0) << run;
    palpate_reset(tool);
  }
}

TEST_F(PalpateWrench, OddCallsAreFaultsOrErrors) {
  palpate_tool* tool = open(options("pads"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double at[3] = {0.0, 0.0, 0.01};
  const double odd[4] = {0.0, nan, 0.0, 1.0};
  WrenchAnswer answer;
  EXPECT_EQ(palpate_wrench(tool, at, nullptr, 0.001, answer.force.data(), nullptr),
            PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_wrench(nullptr, at, nullptr, 0.001, answer.force.data(),
                           answer.torque.data()),
            PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_delivered(nullptr, at, nullptr), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_delivered(tool, nullptr, at), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_delivered(tool, at, odd), PALPATE_ERROR_INPUT);
  EXPECT_EQ(
      palpate_wrench(tool, at, odd, 0.001, answer.force.data(), answer.torque.data()),
      PALPATE_FAULT_NOT_FINITE);
  palpate_reset(tool);
  EXPECT_EQ(palpate_wrench(tool, at, nullptr, 0.001, answer.force.data(),
                           answer.torque.data()),
            PALPATE_FREE);
}

TEST_F(PalpateWrench, ACompilerOfCTakesIt) {
  const ToolRun run = run_tool_process(
      "c_wrench_host", {file_, "pads", "0.001", "0.002", "0.003", "0.05"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const WrenchAnswer here = press(open(options("pads")), 0.003, 0.05);
  std::istringstream words(run.out);
  std::string status;
  Triple force{};
  Triple torque{};
  words >> status;
  for (double& value : force) {
    words >> value;
  }
  for (double& value : torque) {
    words >> value;
  }
  EXPECT_EQ(status, "contact");
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(force[i], here.force[i], 1e-9);
    EXPECT_NEAR(torque[i], here.torque[i], 1e-9);
  }
}

}  // namespace
}  // namespace palpate
