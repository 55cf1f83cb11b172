#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "fitting/curve/corrected_press.h"
#include "fitting/curve/frame_run.h"
#include "formats/base/error.h"
#include "tests/support/synthetic_curve.h"

namespace palpate {
namespace {

// What a machine reports whose frame gives way by u(F).
template <typename Deflection>
Measurement on_frame(Measurement m, const Deflection& u) {
  for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
    m.depth_m[i] += u(m.force_n[i]);
  }
  return m;
}

Measurement on_frame(const Measurement& m, double stiffness) {
  return on_frame(m, [=](double f) {
    return f / stiffness;
  });
}

// A plate that nothing presses in, met after 1 mm: the frame's force over displacement.
template <typename Force>
Measurement plate(const Force& force, double noise_n, unsigned seed) {
  Measurement m = synthetic({.noise_n = noise_n}, seed);
  const Measurement none = synthetic({.noise_n = 0.0}, seed);
  for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
    m.depth_m[i] = 2e-3 * static_cast<double>(i) / 349.0;
    m.force_n[i] += force(std::max(0.0, m.depth_m[i] - 1e-3)) - none.force_n[i];
  }
  return m;
}

std::string complaint(const Measurement& m, const FrameCompliance& frame) {
  try {
    (void)select_approach(m, {}, {}, &frame);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FrameCompliance, OfAConstantStiffnessIsTakenOffExactly) {
  const Measurement sample = synthetic({.noise_n = 0.0}, 1);
  const FrameCompliance frame = linear_frame(500.0);
  const CorrectedPress press = correct_press(on_frame(sample, 500.0), &frame);
  for (std::size_t i = 0; i < press.approach.displacement_m.size(); ++i) {
    EXPECT_NEAR(press.approach.displacement_m[i], sample.depth_m[i], 1e-15);
  }
  EXPECT_NEAR(press.contact.exponent, 1.5, 1e-3);
  EXPECT_NEAR(press.contact.contact_point_m, 2e-3, 1e-6);
  EXPECT_NEAR(press.corrections.frame.deflection_m, 2e-3, 1e-9);
  EXPECT_NEAR(press.corrections.frame.share, 2.0 / 7.0, 1e-3);
  const CorrectedPress without = correct_press(on_frame(sample, 500.0), nullptr);
  EXPECT_GT(std::abs(without.contact.exponent - 1.5), 0.05);
}

TEST(FrameCompliance, KeepsTheSignsOfTheMachine) {
  Measurement m = on_frame(synthetic({}, 2), 500.0);
  const FrameCompliance frame = linear_frame(500.0);
  const CorrectedPress up = correct_press(m, &frame);
  for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
    m.depth_m[i] = -m.depth_m[i];
    m.force_n[i] = -m.force_n[i];
  }
  const CorrectedPress down = correct_press(m, &frame);
  EXPECT_EQ(up.contact.contact_point_m, down.contact.contact_point_m);
  EXPECT_EQ(up.moved.depth_m.back(), -down.moved.depth_m.back());
  EXPECT_EQ(down.samples.depth_m, m.depth_m);
}

TEST(FrameCompliance, IsCountedFromTheForceBeforeContact) {
  const FrameCompliance frame = linear_frame(500.0);
  const CorrectedPress zero = correct_press(on_frame(synthetic({}, 3), 500.0), &frame);
  Measurement m = on_frame(synthetic({}, 3), 500.0);
  for (double& f : m.force_n) {
    f += 10.0;
  }
  EXPECT_NEAR(correct_press(m, &frame).contact.contact_point_m,
              zero.contact.contact_point_m, 1e-9);
}

TEST(FrameCompliance, LeavesAHoldAHold) {
  // While held, force relaxes and the frame springs back: the tip goes on.
  Measurement m = on_frame(synthetic({.noise_n = 1e-4}, 4), 500.0);
  for (int i = 0; i < 100; ++i) {
    m.depth_m.push_back(m.depth_m[349]);
    m.force_n.push_back(0.5 + 0.5 * std::exp(-0.1 * i));
  }
  const FrameCompliance frame = linear_frame(500.0);
  const CorrectedPress press = correct_press(m, &frame);
  EXPECT_EQ(press.approach.hold_samples, 100U);
  EXPECT_NEAR(press.contact.depth_max_m, 5e-3, 1e-4);
  EXPECT_NEAR(press.moved.depth_m.back() - press.moved.depth_m[349], 1e-3, 1e-4);
}

TEST(FrameCompliance, RangesGoByWhatTheMachineReports) {
  const Measurement m = on_frame(synthetic({}, 7), 500.0);
  const FrameCompliance frame = linear_frame(500.0);
  const FitRange range{1e-3, 6e-3};
  EXPECT_EQ(select_approach(m, range, {}, &frame).out_of_range,
            select_approach(m, range).out_of_range);
}

TEST(FrameCompliance, ThatTakesAllIsRefusedAndThatTakesMostFlagged) {
  const Measurement stiff = on_frame(synthetic({.exponent = 1.0}, 5), 100.0);
  const std::string message = complaint(stiff, linear_frame(60.0));
  EXPECT_NE(message.find("takes the whole displacement"), std::string::npos) << message;
  EXPECT_NE(message.find("must be more than"), std::string::npos) << message;
  const FrameCompliance most = linear_frame(100.0);  // 10 mm of 15 mm
  const CorrectedPress press = correct_press(stiff, &most);
  EXPECT_TRUE(press.contact.has(FitFlag::kFrameTakesMost));
  EXPECT_NEAR(press.corrections.frame.share, 2.0 / 3.0, 0.02);
  const FrameCompliance little = linear_frame(1e4);
  EXPECT_FALSE(correct_press(stiff, &little).contact.has(FitFlag::kFrameTakesMost));
}

TEST(FrameCompliance, UncertaintyMovesTheLargestDepth) {
  const FrameCompliance frame = linear_frame(500.0, 50.0);
  const CorrectedPress press = correct_press(on_frame(synthetic({}, 6), 500.0), &frame);
  EXPECT_NEAR(press.corrections.frame.depth_sd_m, 2e-4, 5e-6);  // a tenth of 2 mm
  ASSERT_TRUE(press.softer.has_value());
  EXPECT_NEAR(press.softer->approach.frame_deflection_m,
              1.1 * press.approach.frame_deflection_m, 1e-9);
}

TEST(FrameCompliance, RefusesWhatIsNoStiffness) {
  EXPECT_THROW((void)linear_frame(0.0), InputError);
  EXPECT_THROW((void)linear_frame(-1.0), InputError);
  EXPECT_THROW((void)linear_frame(std::nan("")), InputError);
  EXPECT_THROW((void)linear_frame(1.0, -1.0), InputError);
}

TEST(FrameRun, GivesTheStiffnessOfAStraightFrame) {
  const auto straight = [](double u) {
    return 2e4 * u;
  };
  const FrameRun exact = frame_of_run(plate(straight, 0.0, 1));
  EXPECT_TRUE(exact.frame.linear);
  EXPECT_NEAR(exact.frame.stiffness_n_per_m, 2e4, 1.0);
  int covered = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const FrameRun run = frame_of_run(plate(straight, 0.2, seed));
    EXPECT_TRUE(run.frame.linear) << seed;
    covered += std::abs(run.frame.stiffness_n_per_m - 2e4) <=
                       1.96 * run.frame.stiffness_sd_n_per_m
                   ? 1
                   : 0;
  }
  EXPECT_GE(covered, 50);  // of 60; 95 % are 57, four standard deviations below 50.2
}

TEST(FrameRun, GivesACurveWhereTheFrameStiffens) {
  const auto force = [](double u) {
    return 1e4 * u + 2e7 * u * u;  // 30 N at 1 mm
  };
  const FrameRun run = frame_of_run(plate(force, 0.02, 2));
  EXPECT_FALSE(run.frame.linear);
  for (const double u : {0.2e-3, 0.5e-3, 0.9e-3}) {
    EXPECT_NEAR(deflection_m(run.frame, force(u)), u, 0.02e-3) << u;
    EXPECT_EQ(deflection_m(run.frame, -force(u)), -deflection_m(run.frame, force(u)));
  }
  EXPECT_NEAR(run.frame.stiffness_n_per_m, 3e4, 5e2);
  EXPECT_GT(run.frame.stiffness_sd_n_per_m, 0.0);
  // A sample that is pressed harder than the frame was is refused.
  Measurement sample = synthetic({}, 3);
  for (double& f : sample.force_n) {
    f *= 40.0;
  }
  EXPECT_NE(complaint(sample, run.frame).find("was measured up to"), std::string::npos);
}

TEST(FrameRun, RefusesARunWithoutContact) {
  const auto nothing = [](double) {
    return 0.0;
  };
  EXPECT_THROW((void)frame_of_run(plate(nothing, 0.02, 3)), InputError);
}

}  // namespace
}  // namespace palpate
