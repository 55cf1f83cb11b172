// Two hands on one body through palpate.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/padded_host.h"
#include "tests/support/run_tool.h"

namespace palpate {
namespace {

using Six = std::array<double, 6>;

struct TogetherAnswer {
  int status = 0;
  Six force{};
  Six torque{};
};

class PalpateTogether : public PaddedHost {
 protected:
  palpate_tool* open(const palpate_options& options, const char* second) {
    palpate_close(body_);
    body_ = palpate_open(file_.c_str(), &options, error_, sizeof error_);
    return body_ == nullptr
               ? nullptr
               : palpate_together_open(body_, second, error_, sizeof error_);
  }

  std::string refusal(const std::string& file, const palpate_options& options,
                      const char* second) {
    palpate_body* body = palpate_open(file.c_str(), &options, error_, sizeof error_);
    EXPECT_NE(body, nullptr) << error_;
    EXPECT_EQ(palpate_together_open(body, second, error_, sizeof error_), nullptr);
    palpate_close(body);
    return error_;
  }

  // As examples/pinch.c; the second hand turned about y by `turn`; lengths in units.
  TogetherAnswer pinch(palpate_tool* tool, double apart, double turn = 0.0,
                       double unit = 1.0) {
    const double quaternions[8] = {
        0, 0, 0, 1, 0, std::sin(0.5 * turn), 0, std::cos(0.5 * turn)};
    TogetherAnswer answer;
    for (int tick = 0; tick <= 1000; ++tick) {
      double at[6];
      for (int hand = 0; hand < 2; ++hand) {
        at[3 * hand] = (0.001 + (hand - 0.5) * apart) / unit;
        at[3 * hand + 1] = 0.002 / unit;
        at[3 * hand + 2] = (0.003 + 0.01 * (1000 - tick) / 1000.0) / unit;
      }
      answer.status =
          palpate_together(tool, at, turn == 0.0 ? nullptr : quaternions, 0.001,
                           answer.force.data(), answer.torque.data());
      if (tick % 10 == 0) {
        EXPECT_GE(palpate_slow_step(body_), 0);
      }
    }
    return answer;
  }
};

// padded_plate.h: f = 2e4 d^2, c(r) = 2e-5 / r. With d = sqrt(f / k) + c f for both.
TEST_F(PalpateTogether, EachHandSinksTheBodyUnderTheOther) {
  constexpr double kDepth = 0.002, kApart = 0.014;
  palpate_tool* tool = open(options("ball"), nullptr);
  ASSERT_NE(tool, nullptr) << error_;
  const TogetherAnswer both = pinch(tool, kApart);
  EXPECT_EQ(both.status, PALPATE_CONTACT);
  const double c = 2e-5 / kApart;
  const double root =
      (-1.0 / std::sqrt(2e4) + std::sqrt(1.0 / 2e4 + 4.0 * c * kDepth)) / (2.0 * c);
  EXPECT_NEAR(both.force[2], root * root, 2e-3 * both.force[2]);
  EXPECT_NEAR(both.force[5], both.force[2], 1e-3 * both.force[2]);
  EXPECT_LT(both.force[2], 0.95 * 2e4 * kDepth * kDepth);  // alone
  palpate_state state{};
  state.struct_size = sizeof state;
  palpate_state_get(tool, &state);
  EXPECT_EQ(state.contacts, 2);
  EXPECT_NEAR(state.work_j, state.stored_j + state.tank_j + state.dissipated_j, 1e-12);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(state.force[i], both.force[i]);
    EXPECT_EQ(state.second_force[i], both.force[i + 3]);
  }
  // After a reset both are as new.
  palpate_reset(tool);
  const TogetherAnswer again = pinch(tool, kApart);
  EXPECT_NEAR(again.force[2], both.force[2], 1e-9);
}

TEST_F(PalpateTogether, TheSecondHandsToolIsTurnedBack) {
  palpate_tool* tool = open(options("ball"), "pads");
  ASSERT_NE(tool, nullptr) << error_;
  const TogetherAnswer turned = pinch(tool, 0.03, 0.05);
  EXPECT_LT(turned.torque[4], -1e-4);
  EXPECT_EQ(turned.torque[1], 0.0);
  palpate_state state{};
  state.struct_size = sizeof state;
  palpate_state_get(tool, &state);
  EXPECT_EQ(state.contacts, 4);
  EXPECT_EQ(state.second_torque[1], turned.torque[4]);
  palpate_options other = options("ball");
  other.metres_per_unit = 0.001;
  other.newtons_per_unit = 0.01;
  const TogetherAnswer units = pinch(open(other, "pads"), 0.03, 0.05, 0.001);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(units.force[i], turned.force[i] * 100.0, 1e-8);
    EXPECT_NEAR(units.torque[i], turned.torque[i] * 1e5, 1e-5);
  }
}

// As PalpateWrench.TurnsThatNobodyFeelsGiveTheHandNothing: the second hand's tool is
// tilted down there and comes up tilted.
TEST_F(PalpateTogether, TurnsThatNobodyFeelsGiveTheHandsNothing) {
  palpate_tool* tool = open(options("ball"), "pads");
  ASSERT_NE(tool, nullptr) << error_;
  const double k_n_per_m = palpate_needed_damping(body_) / 0.0005;
  Six held{}, before{-0.02, 0.002, 0.004, 0.02, 0.002, 0.012};
  double put_in_j = 0.0, bound_j = 0.0, largest_n = 0.0;
  for (int tick = 0; tick < 8000; ++tick) {
    const double turn = 2.0 * 3.14159265 * tick / 800.0;
    const double half = 0.15 * std::sin(turn);
    const Six at{-0.02, 0.002, 0.004, 0.02, 0.002, 0.007 + 0.005 * std::cos(turn)};
    const double quaternions[8] = {0, 0, 0, 1, 0, std::sin(half), 0, std::cos(half)};
    for (std::size_t i = 0; i < 6; ++i) {
      const double dx = at[i] - before[i];
      put_in_j -= held[i] * dx;
      bound_j += 2.0 * 0.5 * k_n_per_m * dx * dx;  // of pads, not of the ball
    }
    before = at;
    ASSERT_GE(
        palpate_together(tool, at.data(), quaternions, 0.001, held.data(), nullptr), 0);
    largest_n = std::max(largest_n, held[5]);
    if (tick % 10 == 0) {
      ASSERT_GE(palpate_slow_step(body_), 0);
    }
  }
  EXPECT_GT(largest_n, 0.2);
  EXPECT_GE(put_in_j, -bound_j);
}

TEST_F(PalpateTogether, ToolsOfOneHandLieBesideUnchanged) {
  palpate_tool* pair = open(options("ball"), nullptr);
  palpate_tool* single = palpate_tool_add(body_);
  ASSERT_NE(single, nullptr);
  std::array<double, 3> beside{};
  std::array<double, 3> alone{};
  Six forces{};
  const auto press = [&](palpate_tool* tool, std::array<double, 3>& force) {
    for (int tick = 0; tick <= 1000; ++tick) {
      const double at[3] = {0.001, 0.002, 0.003 + 1e-5 * (1000 - tick)};
      const double two[6] = {0.0, 0.0, at[2], 0.014, 0.0, at[2]};
      if (pair != nullptr) {
        (void)palpate_together(pair, two, nullptr, 0.001, forces.data(), nullptr);
      }
      (void)palpate_force(tool, at, nullptr, 0.001, force.data());
      if (tick % 10 == 0) {
        EXPECT_GE(palpate_slow_step(body_), 0);
      }
    }
  };
  press(single, beside);
  EXPECT_GT(forces[2], 0.05);
  const palpate_options ball = options("ball");
  palpate_close(body_);
  body_ = palpate_open(file_.c_str(), &ball, error_, sizeof error_);
  pair = nullptr;
  press(palpate_tool_add(body_), alone);
  EXPECT_EQ(beside, alone);
}

TEST_F(PalpateTogether, AStreamedBodyAnswersAsOneInMemory) {
  palpate_options streamed = options("ball");
  streamed.flags |= PALPATE_STREAMED;
  const TogetherAnswer memory = pinch(open(options("ball"), "pads"), 0.014, 0.05);
  palpate_tool* tool = open(streamed, "pads");
  ASSERT_NE(tool, nullptr) << error_;
  const TogetherAnswer file = pinch(tool, 0.014, 0.05);
  EXPECT_GT(memory.force[2], 0.05);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(file.force[i], memory.force[i], 1e-9);
    EXPECT_NEAR(file.torque[i], memory.torque[i], 1e-11);
  }
}

TEST_F(PalpateTogether, RefusesWithASentence) {
  const auto says = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(says(refusal(without_, options("ball"), nullptr), "no table of"))
      << error_;
  EXPECT_TRUE(says(refusal(file_, options("ball"), "thumb"), "thumb")) << error_;
  palpate_options element = options("ball");
  element.model = "element";
  EXPECT_TRUE(says(refusal(file_, element, nullptr), "potential")) << error_;
  EXPECT_EQ(palpate_together_open(nullptr, nullptr, error_, sizeof error_), nullptr);
  EXPECT_TRUE(says(error_, "null")) << error_;
  // The second tool alone is too stiff for the device.
  palpate_options weak = options("ball");
  weak.device_damping_n_s_per_m = 0.2;
  EXPECT_TRUE(says(refusal(file_, weak, "pads"), "contacts together")) << error_;
  weak.flags |= PALPATE_LIMIT_STIFFNESS;
  palpate_tool* limited = open(weak, "pads");
  ASSERT_NE(limited, nullptr) << error_;
  palpate_state state{};
  state.struct_size = sizeof state;
  palpate_state_get(limited, &state);
  EXPECT_LT(state.force_scale, 1.0);
  const TogetherAnswer softer = pinch(limited, 0.03);
  const TogetherAnswer whole = pinch(open(options("ball"), "pads"), 0.03);
  EXPECT_NEAR(softer.force[2] / whole.force[2], state.force_scale, 0.01);
}

TEST_F(PalpateTogether, CallsAreForTheirTools) {
  palpate_tool* pair = open(options("ball"), nullptr);
  palpate_tool* single = palpate_tool_add(body_);
  const double at[6] = {0.0, 0.0, 0.02, 0.014, 0.0, 0.02};
  Six forces{1, 1, 1, 1, 1, 1};
  EXPECT_EQ(palpate_force(pair, at, nullptr, 0.001, forces.data()),
            PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_together(single, at, nullptr, 0.001, forces.data(), nullptr),
            PALPATE_ERROR_INPUT);
  EXPECT_EQ(forces, Six{});
  EXPECT_EQ(palpate_together(nullptr, at, nullptr, 0.001, forces.data(), nullptr),
            PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_together(pair, at, nullptr, 0.001, nullptr, nullptr),
            PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_together(pair, at, nullptr, 0.001, forces.data(), nullptr),
            PALPATE_FREE);
  // The second hand's number counts as much as the first's.
  Six odd{0.0, 0.0, 0.02, 0.0, std::numeric_limits<double>::quiet_NaN(), 0.0};
  EXPECT_EQ(palpate_together(pair, odd.data(), nullptr, 0.001, forces.data(), nullptr),
            PALPATE_FAULT_NOT_FINITE);
  palpate_reset(pair);
  EXPECT_EQ(palpate_together(pair, at, nullptr, 0.001, forces.data(), nullptr),
            PALPATE_FREE);
}

TEST_F(PalpateTogether, ACompilerOfCGetsTheSameBits) {
  const ToolRun run = run_tool_process(
      "c_pinch_host", {file_, "ball", "pads", "0.001", "0.002", "0.003", "0.03"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const TogetherAnswer here = pinch(open(options("ball"), "pads"), 0.03);
  std::istringstream words(run.out);
  std::string status;
  Six force{};
  words >> status;
  for (double& value : force) {
    words >> value;
  }
  EXPECT_EQ(status, "contact");
  EXPECT_EQ(force, here.force);
  EXPECT_GT(force[5], force[2]);
}

}  // namespace
}  // namespace palpate
