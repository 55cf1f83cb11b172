#include "fitting/curve/adhesion.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "fitting/curve/corrected_press.h"
#include "fitting/curve/jkr_fit.h"

namespace palpate {
namespace {

constexpr double kRadius = 5e-3, kModulus = 1e4;  // [m], [Pa] E*

struct Sticky {
  double work_j_per_m2 = 0.0;
  double noise_n = 1e-4;
  double after_n = 0.0;  // of the sensor's zero, once the tool has left
};

// Force of Johnson, Kendall and Roberts at contact radius a, and the depth.
double force_of_radius_n(double a, double work) {
  return 4.0 * kModulus * a * a * a / (3.0 * kRadius) -
         std::sqrt(8.0 * std::numbers::pi * work * kModulus * a * a * a);
}
double depth_of_radius_m(double a, double work) {
  return a * a / kRadius - std::sqrt(2.0 * std::numbers::pi * work * a / kModulus);
}

// On the stable branch; 0 where there is no contact.
double jkr_force_at_n(double depth, double work) {
  double low =
      std::cbrt(std::numbers::pi * work * kRadius * kRadius / (8.0 * kModulus));
  double high = 2.0 * kRadius;  // depth is least at `low`
  if (depth < depth_of_radius_m(low, work)) {
    return 0.0;
  }
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (depth_of_radius_m(middle, work) < depth ? low : high) = middle;
  }
  return force_of_radius_n(low, work);
}

// 1.5 mm free, 1 mm deep, and back: jumps into contact at depth 0, leaves at the least.
Measurement press(const Sticky& c, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0.0, c.noise_n);
  Measurement m;
  for (int i = 0; i <= 1000; ++i) {
    const double x = 2.5e-3 * (i <= 500 ? i : 1000 - i) / 500.0, d = x - 1.5e-3;
    const bool touches = d >= 0.0 || i > 500;
    const double force = touches ? jkr_force_at_n(d, c.work_j_per_m2) : 0.0;
    m.depth_m.push_back(x);
    m.force_n.push_back(force + normal(generator) +
                        (i > 500 && d < 0.0 ? c.after_n : 0.0));
  }
  return m;
}

TEST(Adhesion, WorkFollowsFromThePullOff) {
  EXPECT_NEAR(jkr_work_of_adhesion(1.5 * std::numbers::pi * 0.3 * kRadius, kRadius),
              0.3, 1e-15);
  EXPECT_NEAR(dmt_work_of_adhesion(2.0 * std::numbers::pi * 0.3 * kRadius, kRadius),
              0.3, 1e-15);
}

TEST(Adhesion, IsSeenFlaggedAndMeasured) {
  const double work = 0.2;  // J/m^2
  const CorrectedPress fit = correct_press(press({.work_j_per_m2 = work}, 1), nullptr);
  const Adhesion& a = fit.corrections.adhesion;
  EXPECT_TRUE(a.pulls_off);
  EXPECT_TRUE(a.snaps_in);
  EXPECT_TRUE(fit.contact.has(FitFlag::kAdhesion));
  EXPECT_NEAR(jkr_work_of_adhesion(a.pull_off_n, kRadius), work, 0.02 * work);
  // At depth 0 the pull is 8/9 of the pull-off (Johnson, Kendall and Roberts 1971).
  EXPECT_NEAR(a.snap_in_n / a.pull_off_n, 8.0 / 9.0, 0.03);
  EXPECT_NEAR(a.noise_n, 1e-4, 2e-5);
}

TEST(Adhesion, IsNotSeenWhereThereIsNone) {
  int seen = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    seen += correct_press(press({}, seed), nullptr).corrections.adhesion.seen() ? 1 : 0;
  }
  EXPECT_EQ(seen, 0);
}

TEST(Adhesion, ASensorThatDoesNotComeBackToZeroIsNone) {
  const CorrectedPress fit = correct_press(press({.after_n = -2e-3}, 1), nullptr);
  EXPECT_FALSE(fit.corrections.adhesion.seen());
}

TEST(Adhesion, ASingleWildReadingIsNone) {
  Measurement m = press({}, 2);
  m.force_n[900] = -1.0;
  EXPECT_FALSE(correct_press(m, nullptr).corrections.adhesion.seen());
}

TEST(Adhesion, NothingIsToldWithoutFreeSamples) {
  Measurement m = press({}, 1);
  m.depth_m.erase(m.depth_m.begin(), m.depth_m.begin() + 400);
  m.force_n.erase(m.force_n.begin(), m.force_n.begin() + 400);
  const Adhesion a = correct_press(m, nullptr).corrections.adhesion;
  EXPECT_FALSE(a.seen());
  EXPECT_TRUE(std::isnan(a.noise_n));
}

TEST(JkrFit, ForceIsThatOfItsRadiusOfContact) {
  for (const double work : {1e-6, 0.01, 0.2, 5.0}) {
    const double least =
        std::cbrt(std::numbers::pi * work * kRadius * kRadius / (8.0 * kModulus));
    for (const double factor : {1.001, 1.1, 2.0, 10.0}) {
      const double a = factor * least;
      EXPECT_NEAR(jkr_force_n(depth_of_radius_m(a, work), kRadius, kModulus, work),
                  force_of_radius_n(a, work),
                  1e-9 * std::abs(force_of_radius_n(least, work)))
          << work << " " << factor;
    }
  }
  // Without adhesion it is Hertz, and at depth 0 it is 8/9 of the pull-off.
  EXPECT_NEAR(jkr_force_n(1e-3, kRadius, kModulus, 1e-12),
              4.0 / 3.0 * kModulus * std::sqrt(kRadius) * std::pow(1e-3, 1.5), 1e-6);
  EXPECT_NEAR(jkr_force_n(0.0, kRadius, kModulus, 0.3),
              -8.0 / 9.0 * 1.5 * std::numbers::pi * 0.3 * kRadius, 1e-9);
}

TEST(JkrFit, GivesBackWhatWentIn) {
  const double work = 0.2;
  int covered = 0;
  constexpr int kRuns = 40;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const CorrectedPress fit =
        correct_press(press({.work_j_per_m2 = work}, seed), nullptr);
    const JkrFit jkr = fit_jkr(fit.approach, fit.corrections.adhesion, kRadius);
    ASSERT_EQ(jkr.refused, "") << seed;
    EXPECT_NEAR(jkr.contact_point_m, 1.5e-3, 2e-5);
    EXPECT_NEAR(jkr.reduced_modulus_pa, kModulus, 0.03 * kModulus);
    EXPECT_NEAR(jkr.work_j_per_m2, work, 0.05 * work);
    covered +=
        std::abs(jkr.reduced_modulus_pa - kModulus) <= 1.96 * jkr.reduced_modulus_sd_pa
            ? 1
            : 0;
  }
  EXPECT_GE(covered, 32);  // 38 are wanted; five standard deviations below are 31.1
}

TEST(JkrFit, IsRefusedWhereTheLawDoesNotHold) {
  const auto reason = [](const Measurement& m) {
    const CorrectedPress fit = correct_press(m, nullptr);
    return fit_jkr(fit.approach, fit.corrections.adhesion, kRadius).refused;
  };
  EXPECT_EQ(reason(press({}, 1)), "no pull-off is seen");
  // Twice the pull on the way back: bonds that had time to form.
  Measurement m = press({.work_j_per_m2 = 0.1}, 1);
  const Measurement more = press({.work_j_per_m2 = 0.25}, 1);
  std::copy(more.force_n.begin() + 501, more.force_n.end(), m.force_n.begin() + 501);
  EXPECT_NE(reason(m).find("not in equilibrium"), std::string::npos) << reason(m);
}

}  // namespace
}  // namespace palpate
