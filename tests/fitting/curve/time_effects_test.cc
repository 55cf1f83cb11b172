#include "fitting/curve/time_effects.h"

#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "fitting/curve/segments.h"
#include "formats/base/error.h"
#include "formats/measurement/measurement_file.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

TEST(Relaxation, RecoversATwoTermSeries) {
  std::vector<double> t, f;
  for (int i = 0; i < 200; ++i) {
    t.push_back(5.0 + 0.05 * i);
    const double s = 0.05 * i;
    f.push_back(2.0 * (0.5 + 0.2 * std::exp(-s / 0.4) + 0.3 * std::exp(-s / 4.0)));
  }
  const Relaxation r = fit_relaxation(t, f);
  ASSERT_TRUE(r.converged);
  EXPECT_NEAR(r.force_n, 2.0, 1e-6);
  EXPECT_NEAR(r.g_inf, 0.5, 1e-4);
  EXPECT_NEAR(r.g[0], 0.2, 1e-4);
  EXPECT_NEAR(r.g[1], 0.3, 1e-4);
  EXPECT_NEAR(r.tau_s[0], 0.4, 1e-3);
  EXPECT_NEAR(r.tau_s[1], 4.0, 1e-2);
  EXPECT_LT(r.rms_relative, 1e-6);
}

TEST(Relaxation, IsRefusedWithoutTimeAndWithoutAHold) {
  Measurement m{{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}};
  EXPECT_EQ(find_relaxation(m).refused, "no time column");
  m.time_s = m.depth_m;
  EXPECT_NE(find_relaxation(m).refused.find("no hold"), std::string::npos);
  EXPECT_THROW((void)fit_relaxation(m.time_s, m.force_n), InputError);
}

TEST(Relaxation, StatesTheSpeedOfThePressBeforeTheHold) {
  Measurement m;
  for (int i = 0; i < 600; ++i) {  // slow to 2 mm, 3 mm/s to 8 mm, then still
    const double t = 0.01 * i;
    const double x = t < 1.0 ? 2e-3 * t : std::min(8e-3, 2e-3 + 3e-3 * (t - 1.0));
    m.time_s.push_back(t);
    m.depth_m.push_back(x);
    m.force_n.push_back(t < 3.0 ? 100.0 * x : 0.8 * (0.5 + 0.5 * std::exp(3.0 - t)));
  }
  const Relaxation r = find_relaxation(m);
  ASSERT_EQ(r.refused, "");
  EXPECT_NEAR(r.speed_m_per_s, 3e-3, 3e-5);  // a sample of the half is 0.8 %
}

// Press and release at 10 mm/s along a law with damping.
Measurement damped_loop(double lambda_s_per_m, double release_gain) {
  Measurement m;
  for (int i = 0; i <= 800; ++i) {
    const bool press = i <= 400;
    const double x = 2.5e-5 * (press ? i : 800 - i), d = std::max(0.0, x - 2e-3);
    const double speed = press ? 0.01 : -0.01;
    const double force = 3000.0 * std::pow(d, 1.5) * (1.0 + lambda_s_per_m * speed);
    m.time_s.push_back(2.5e-3 * i);
    m.depth_m.push_back(x);
    m.force_n.push_back(press ? force : release_gain * force);
  }
  return m;
}

TEST(Loop, HuntAndCrossleysLawIsRecovered) {
  const Measurement m = damped_loop(20.0, 1.0);
  const Approach approach = select_approach(m);
  const LoopFit fit = find_loop(m, approach, fit_contact(approach));
  ASSERT_EQ(fit.refused, "");
  EXPECT_NEAR(fit.exponent, 1.5, 0.02);
  EXPECT_NEAR(fit.lambda_s_per_m, 20.0, 0.5);
  // Press 1.2, release 0.8 of the same work: 0.4 / (pi 2).
  EXPECT_NEAR(fit.loss_factor, 0.4 / (3.14159265 * 2.0), 1e-3);
}

TEST(Loop, ThatGivesMoreThanItTookIsNotFitted) {
  const Measurement m = damped_loop(0.0, 1.02);
  const Approach approach = select_approach(m);
  const LoopFit fit = find_loop(m, approach, fit_contact(approach));
  EXPECT_NE(fit.refused.find("more work"), std::string::npos);
  EXPECT_TRUE(std::isnan(fit.loss_factor));
}

TEST(Segments, AreThoseOfTwoPressesWithAHoldBetween) {
  std::vector<double> x;
  const auto move = [&](double to, int steps) {
    const double from = x.empty() ? 0.0 : x.back();
    for (int i = 1; i <= steps; ++i) {
      x.push_back(from + (to - from) * i / steps);
    }
  };
  move(1.0, 100);
  move(1.0, 50);
  move(0.3, 80);
  move(1.5, 100);
  move(0.0, 100);
  std::vector<SegmentKind> kinds;
  std::size_t next = 0;
  for (const Segment& s : find_segments(x)) {
    kinds.push_back(s.kind);
    EXPECT_EQ(s.begin, next);
    next = s.end;
  }
  EXPECT_EQ(next, x.size());
  EXPECT_EQ(kinds,
            (std::vector<SegmentKind>{SegmentKind::kApproach, SegmentKind::kHold,
                                      SegmentKind::kRetract, SegmentKind::kApproach,
                                      SegmentKind::kRetract}));
}

TEST(Relaxation, PorkFollowsTwoTermsToHalfAPercent) {
  const auto folder = test_data("pork_indent_relax");
  if (!folder) {
    GTEST_SKIP() << "no test data";
  }
  for (const auto& file : std::filesystem::directory_iterator(*folder)) {
    if (file.path().extension() != ".csv") {
      continue;
    }
    const Relaxation r =
        find_relaxation(read_measurement(file, {{"displacement", "mm"},
                                                {"force", "N"},
                                                MeasurementColumn{"time", "s"}})
                            .samples);
    ASSERT_EQ(r.refused, "") << file.path();
    EXPECT_LE(r.rms_relative, 5e-3) << file.path();
    EXPECT_NEAR(r.end_over_start, 0.46, 0.1) << file.path();
    ASSERT_EQ(r.joint.refused, "") << file.path();
    EXPECT_LE(r.joint.rms_relative, 1e-2) << file.path();
    EXPECT_LT(r.joint.g_inf, r.g_inf) << file.path();  // the press hid some of it
  }
}

}  // namespace
}  // namespace palpate
