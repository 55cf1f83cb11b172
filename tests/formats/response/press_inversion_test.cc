#include "formats/response/press_inversion.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/relaxation_reference.h"

namespace palpate {
namespace {

constexpr double kDeepestM = 0.005;

double hertz_n(double d) {
  return 2.0 * std::pow(std::max(0.0, d) / kDeepestM, 1.5);
}

double hertz_n_per_m(double d) {
  return 3.0 / kDeepestM * std::sqrt(std::max(0.0, d) / kDeepestM);
}

// The force of a press at a speed, in 20 000 steps.
OwnedCurve press(const PronyTerms2& terms, double speed_m_per_s, int samples) {
  constexpr int kSteps = 20000;
  RelaxationReference reference(terms);
  OwnedCurve curve{{0.0}, {0.0}, {0.0}, {0.0}};
  double before_n = 0.0;
  const double h = kDeepestM / kSteps;
  for (int i = 1; i <= kSteps; ++i) {
    const double force_n = reference.step(hertz_n(i * h), h / speed_m_per_s);
    if (i % (kSteps / samples) == 0) {
      curve.depth_m.push_back(i * h);
      curve.force_n.push_back(force_n);
      curve.stiffness_n_per_m.push_back((force_n - before_n) / h);
      curve.energy_j.push_back(0.0);
    }
    before_n = force_n;
  }
  return curve;
}

Eigen::RowVectorXd shares(const PronyTerms2& terms) {
  return Eigen::RowVector2d(terms.g[0], terms.g[1]);
}

TEST(PressInversion, FindsTheInstantaneousCurveWithinTwoThousandths) {
  for (const PronyTerms2& terms : {kPork, kShortTimes}) {
    for (const double speed : {0.0005, 0.001, 0.005, 0.05}) {
      const OwnedCurve slow = press(terms, speed, 32);
      const OwnedCurve curve = instantaneous_curve(
          slow.view(), shares(terms), {terms.tau_s[0], terms.tau_s[1]}, speed);
      double worst = 0.0;
      for (std::size_t i = 5; i < curve.depth_m.size(); ++i) {
        const double wanted = hertz_n(curve.depth_m[i]);
        worst = std::max(worst, std::abs(curve.force_n[i] / wanted - 1.0));
        EXPECT_NEAR(curve.stiffness_n_per_m[i], hertz_n_per_m(curve.depth_m[i]),
                    0.01 * hertz_n_per_m(curve.depth_m[i]))
            << speed << " " << i;
      }
      EXPECT_LE(worst, 2e-3) << speed << " " << terms.tau_s[0];
    }
  }
}

TEST(PressInversion, OfASuddenPressChangesNothing) {
  const OwnedCurve sudden = press(kPork, 1e6, 32);
  const OwnedCurve curve =
      instantaneous_curve(sudden.view(), shares(kPork), {0.42, 4.5}, 1e6);
  for (std::size_t i = 0; i < curve.depth_m.size(); ++i) {
    EXPECT_NEAR(curve.force_n[i], sudden.force_n[i], 1e-7);
  }
}

TEST(PressInversion, OfAVerySlowPressDividesByWhatStays) {
  const OwnedCurve slow = press(kPork, 1e-6, 32);
  const OwnedCurve curve =
      instantaneous_curve(slow.view(), shares(kPork), {0.42, 4.5}, 1e-6);
  EXPECT_NEAR(curve.force_n.back(), hertz_n(kDeepestM), 1e-5);
  EXPECT_NEAR(slow.force_n.back(), 0.439 * hertz_n(kDeepestM), 2e-3);
}

TEST(PressInversion, KeepsCurvesThatDoNotOvershoot) {
  const OwnedCurve slow = press(kShortTimes, 0.0005, 32);
  const OwnedCurve curve =
      instantaneous_curve(slow.view(), shares(kShortTimes), {0.004, 0.06}, 0.0005);
  for (std::size_t i = 1; i < curve.depth_m.size(); ++i) {
    const double secant = (curve.force_n[i] - curve.force_n[i - 1]) /
                          (curve.depth_m[i] - curve.depth_m[i - 1]);
    EXPECT_LE(curve.stiffness_n_per_m[i], 3.0 * secant + 1e-12);
    EXPECT_LE(curve.stiffness_n_per_m[i - 1], 3.0 * secant + 1e-12);
    EXPECT_GE(curve.stiffness_n_per_m[i], 0.0);
    EXPECT_GT(curve.energy_j[i], curve.energy_j[i - 1]);
  }
}

TEST(PressInversion, LeavesInstantaneousAndStaticCurvesAlone) {
  const OwnedCurve slow = press(kPork, 0.001, 32);
  Viscoelasticity relaxation;
  EXPECT_EQ(instantaneous_curve(slow.view(), relaxation, 0).force_n, slow.force_n);
  relaxation.tau_s = {0.42, 4.5};
  relaxation.g = (RowsOf<float>(1, 2) << 0.258F, 0.303F).finished();
  relaxation.speed_m_per_s = 0.001;
  EXPECT_GT(instantaneous_curve(slow.view(), relaxation, 3).force_n.back(),
            1.4 * slow.force_n.back());
  EXPECT_NEAR(stiffness_factor(relaxation), 1.0 / 0.439, 1e-6);
  relaxation.instantaneous = true;
  EXPECT_EQ(instantaneous_curve(slow.view(), relaxation, 3).force_n, slow.force_n);
  EXPECT_EQ(stiffness_factor(relaxation), 1.0);
}

TEST(PressInversion, SlopesStayBelowTheStatedFactor) {
  for (const double speed : {1e-5, 0.0005, 0.01}) {
    const OwnedCurve slow = press(kPork, speed, 64);
    const OwnedCurve curve =
        instantaneous_curve(slow.view(), shares(kPork), {0.42, 4.5}, speed);
    const double before =
        *std::max_element(slow.stiffness_n_per_m.begin(), slow.stiffness_n_per_m.end());
    const double after = *std::max_element(curve.stiffness_n_per_m.begin(),
                                           curve.stiffness_n_per_m.end());
    EXPECT_LE(after, before / 0.439 * (1.0 + 1e-6)) << speed;
  }
}

}  // namespace
}  // namespace palpate
