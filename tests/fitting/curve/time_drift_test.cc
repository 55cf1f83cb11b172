#include "fitting/curve/time_drift.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "fitting/curve/corrected_press.h"
#include "tests/support/synthetic_curve.h"

namespace palpate {
namespace {

struct Loop {
  double drift_n_per_s = 0.0;
  double leap_n = 0.0;  // of the baseline, when the retract begins
  double noise_n = 0.005;
  bool retract = true;
  int dwell = 0;  // samples
};

// Press and release of an elastic sample, 10 samples a second.
Measurement drifting_loop(const Loop& c, unsigned seed) {
  const Measurement press = synthetic({.noise_n = 0.0}, 1);
  Measurement m;
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0.0, c.noise_n);
  const auto add = [&](double x, double f) {
    const double t = 0.1 * static_cast<double>(m.depth_m.size());
    m.time_s.push_back(t);
    m.depth_m.push_back(x);
    m.force_n.push_back(f + c.drift_n_per_s * t + normal(generator));
  };
  for (int i = 0; i < c.dwell; ++i) {
    add(0.0, 0.0);
  }
  for (std::size_t i = 0; i < press.depth_m.size(); ++i) {
    add(press.depth_m[i], press.force_n[i]);
  }
  for (std::size_t i = press.depth_m.size(); c.retract && i-- > 0;) {
    add(press.depth_m[i], press.force_n[i] + c.leap_n);
  }
  return m;
}

TEST(TimeDrift, OfALoopIsFoundAndTakenOff) {
  const CorrectedPress press =
      correct_press(drifting_loop({.drift_n_per_s = 2e-3}, 1), nullptr);
  const TimeDrift& drift = press.corrections.drift;
  EXPECT_EQ(drift.refused, "");
  EXPECT_TRUE(drift.significant);
  EXPECT_NEAR(drift.n_per_s, 2e-3, 4.0 * drift.sd_n_per_s);
  EXPECT_LT(drift.sd_n_per_s, 1e-4);
  EXPECT_TRUE(press.contact.has(FitFlag::kTimeDriftRemoved));
  EXPECT_NEAR(press.samples.force_n.back(), 0.0, 0.03);  // 0.14 N before
  // The release then gives back what the press took.
  EXPECT_NEAR(press.approach.release_work_j / press.approach.press_work_j, 1.0, 0.02);
}

TEST(TimeDrift, IsFoundWithTheForceTurned) {
  Measurement m = drifting_loop({.drift_n_per_s = 2e-3}, 1);
  for (double& f : m.force_n) {
    f = -f;
  }
  const CorrectedPress press = correct_press(m, nullptr);
  EXPECT_NEAR(press.samples.force_n.back(), 0.0, 0.03);
}

TEST(TimeDrift, IsNotFoundWhereThereIsNone) {
  int found = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const Measurement m = drifting_loop({}, seed);
    const CorrectedPress press = correct_press(m, nullptr);
    found += press.corrections.drift.significant ? 1 : 0;
    if (!press.corrections.drift.significant) {
      EXPECT_EQ(press.samples.force_n, m.force_n);
    }
  }
  EXPECT_EQ(found, 0);
}

TEST(TimeDrift, IsFoundInADwellBeforeAPress) {
  const CorrectedPress press = correct_press(
      drifting_loop({.drift_n_per_s = 2e-3, .retract = false, .dwell = 100}, 2),
      nullptr);
  EXPECT_TRUE(press.corrections.drift.significant);
  EXPECT_NEAR(press.corrections.drift.n_per_s, 2e-3,
              4.0 * press.corrections.drift.sd_n_per_s);
}

TEST(TimeDrift, IsRefusedWhereItCannotBeTold) {
  const auto refused = [](const Measurement& m) {
    return correct_press(m, nullptr).corrections.drift.refused;
  };
  EXPECT_NE(refused(drifting_loop({.drift_n_per_s = 2e-3, .retract = false}, 3))
                .find("cannot be distinguished from one with displacement"),
            std::string::npos);
  EXPECT_EQ(refused(synthetic({}, 1)), "no time column");
  const CorrectedPress leap = correct_press(drifting_loop({.leap_n = 0.1}, 4), nullptr);
  EXPECT_TRUE(leap.corrections.drift.leaps);
  EXPECT_NE(leap.corrections.drift.refused.find("leaps by 0.0"), std::string::npos)
      << leap.corrections.drift.refused;
}

}  // namespace
}  // namespace palpate
