#include "fitting/curve/joint_relaxation.h"

#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(QuasiLinear, SpringPressedAtConstantSpeedHasItsClosedForm) {
  // f = k v [(1 - g) t + g tau (1 - exp(-t / tau))], the standard linear solid's.
  const double k = 300.0, v = 2e-3, g = 0.7, tau = 0.3;
  Eigen::VectorXd t(7);
  t << 0.0, 0.01, 0.2, 0.2, 0.5, 3.0, 50.0;  // steps of any length, and none
  const Eigen::VectorXd q = relaxed_force(t, k * v * t, tau);
  for (Eigen::Index i = 0; i < t.size(); ++i) {
    const double exact = k * v * ((1.0 - g) * t[i] - g * tau * std::expm1(-t[i] / tau));
    EXPECT_NEAR(k * v * t[i] - g * q[i], exact, 1e-13 * (1.0 + exact)) << t[i];
  }
}

// Of a sphere's curve with 0.5 mm of free travel; exact over each of many small steps.
struct Pressed {
  std::vector<double> time_s, displacement_m, force_n;
  std::size_t hold_begin = 0, hold_end = 0;

  [[nodiscard]] PressAndHold view() const {
    return {time_s, displacement_m, force_n, hold_begin, hold_end};
  }
};

constexpr double kFree = 5e-4, kDepth = 4e-3, kForce = 2.0;

Pressed pressed(const std::vector<RelaxationTerm>& terms, double speed_m_per_s,
                double rate_hz, double hold_s, double noise_n = 0.0,
                double release_s = 0.0) {
  constexpr int kSteps = 40;
  std::mt19937 generator(11);
  std::normal_distribution<double> normal(0.0, 1.0);
  const double press_s = (kFree + kDepth) / speed_m_per_s, h = 1.0 / rate_hz / kSteps;
  Pressed p;
  std::vector<double> q(terms.size(), 0.0);
  double before = 0.0;
  for (int i = 0; i * h <= press_s + hold_s + release_s; ++i) {
    const double t = i * h, back = std::max(0.0, t - press_s - hold_s);
    const double x = speed_m_per_s * (std::min(t, press_s) - back);
    const double e = kForce * std::pow(std::max(0.0, x - kFree) / kDepth, 1.5);
    double force = e;
    for (std::size_t k = 0; k < q.size(); ++k) {
      q[k] -= std::expm1(-h / terms[k].tau_s) * (0.5 * (before + e) - q[k]);
      force -= terms[k].g * q[k];
    }
    before = e;
    if (i % kSteps == 0) {
      p.hold_begin += t < press_s ? 1 : 0;
      p.hold_end += t <= press_s + hold_s ? 1 : 0;
      p.time_s.push_back(t);
      p.displacement_m.push_back(x);
      p.force_n.push_back(0.02 + force + noise_n * normal(generator));
    }
  }
  return p;
}

std::vector<RelaxationTerm> terms_of(
    std::initializer_list<std::pair<double, double>> pairs) {
  std::vector<RelaxationTerm> terms;
  for (const auto& [g, tau_s] : pairs) {
    terms.emplace_back();
    terms.back().g = g;
    terms.back().tau_s = tau_s;
  }
  return terms;
}

void expect_terms(const JointRelaxation& found,
                  const std::vector<RelaxationTerm>& truth, double relative) {
  ASSERT_EQ(found.refused, "");
  ASSERT_EQ(found.terms.size(), truth.size());
  for (std::size_t k = 0; k < truth.size(); ++k) {
    EXPECT_NEAR(found.terms[k].g, truth[k].g, relative * truth[k].g) << k;
    EXPECT_NEAR(found.terms[k].tau_s, truth[k].tau_s, relative * truth[k].tau_s) << k;
    EXPECT_EQ(found.terms[k].not_claimed, "");
  }
}

TEST(JointRelaxation, FindsTermsAndInstantaneousCurveAtAnySpeed) {
  const auto truth = terms_of({{0.26, 0.42}, {0.30, 4.5}});
  for (const auto& [speed, rate] : {std::pair{5e-4, 20.0}, std::pair{5e-2, 200.0}}) {
    const JointRelaxation found =
        fit_press_and_hold(pressed(truth, speed, rate, 15.0, 2e-4).view());
    expect_terms(found, truth, 0.02);
    EXPECT_NEAR(found.force_n.back(), kForce, 0.01 * kForce) << speed;
    EXPECT_NEAR(found.displacement_m.front(), kFree, 2e-5) << speed;
    EXPECT_NEAR(found.baseline_n, 0.02, 1e-3);
  }
}

TEST(JointRelaxation, TwoSpeedsAgreeWithinTheirIntervals) {
  const auto truth = terms_of({{0.26, 0.42}, {0.30, 4.5}});
  const JointRelaxation slow =
      fit_press_and_hold(pressed(truth, 5e-4, 20.0, 15.0, 5e-3).view());
  const JointRelaxation fast =
      fit_press_and_hold(pressed(truth, 5e-2, 200.0, 15.0, 5e-3).view());
  ASSERT_EQ(slow.terms.size(), 2U);
  ASSERT_EQ(fast.terms.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const RelaxationTerm &a = slow.terms[k], &b = fast.terms[k];
    EXPECT_LE(std::abs(a.g - b.g), 2.5 * std::hypot(a.g_sd, b.g_sd));
    EXPECT_LE(std::abs(std::log(a.tau_s / b.tau_s)),
              2.5 * std::hypot(a.tau_sd_s / a.tau_s, b.tau_sd_s / b.tau_s));
    EXPECT_LT(a.g_sd, 0.1);  // and they say something
    EXPECT_LT(b.g_sd, 0.1);
  }
}

TEST(JointRelaxation, TakesAsManyTermsAsThereAre) {
  const auto one = terms_of({{0.4, 1.5}});
  expect_terms(fit_press_and_hold(pressed(one, 2e-3, 20.0, 15.0, 2e-3).view()), one,
               0.05);
  const auto three = terms_of({{0.2, 0.2}, {0.2, 1.5}, {0.2, 9.0}});
  expect_terms(fit_press_and_hold(pressed(three, 5e-3, 50.0, 30.0, 2e-4).view()), three,
               0.1);
}

TEST(JointRelaxation, TellsWhatIsGoneWithinATime) {
  const std::vector<RelaxationTerm> terms = terms_of({{0.26, 0.4}, {0.3, 4.0}});
  const JointRelaxation found =
      fit_press_and_hold(pressed(terms, 1e-3, 20.0, 10.0, 5e-3).view());
  ASSERT_TRUE(found.refused.empty()) << found.refused;
  const auto K = std::ssize(found.terms);
  ASSERT_EQ(found.covariance.rows(), 2 * K);
  for (Eigen::Index k = 0; k < K; ++k) {
    const RelaxationTerm& term = found.terms[static_cast<std::size_t>(k)];
    EXPECT_NEAR(std::sqrt(found.covariance(k, k)), term.g_sd, 1e-12);
    EXPECT_NEAR(term.tau_s * std::sqrt(found.covariance(K + k, K + k)), term.tau_sd_s,
                1e-12);
  }
  // At last all of it, known as well as what stays.
  const RelaxedShare last = relaxed_within(found, 1e4);
  EXPECT_NEAR(last.value, 1.0 - found.g_inf, 1e-12);
  EXPECT_NEAR(last.sd, found.g_inf_sd, 1e-9);
  EXPECT_EQ(relaxed_within(found, 0.0).value, 0.0);
  EXPECT_EQ(relaxed_within(found, 0.0).sd, 0.0);
  const double exact = -0.26 * std::expm1(-2.0 / 0.4) - 0.3 * std::expm1(-2.0 / 4.0);
  const RelaxedShare at = relaxed_within(found, 2.0);
  EXPECT_NEAR(at.value, exact, 4.0 * at.sd);
  JointRelaxation told = found;
  told.covariance.resize(0, 0);
  EXPECT_TRUE(std::isnan(relaxed_within(told, 1.0).sd));
}

TEST(JointRelaxation, DoesNotClaimWhatTheHoldIsTooShortFor) {
  const auto truth = terms_of({{0.3, 0.5}, {0.3, 60.0}});
  const JointRelaxation found =
      fit_press_and_hold(pressed(truth, 5e-3, 50.0, 10.0, 1e-3).view());
  ASSERT_EQ(found.terms.size(), 2U);
  EXPECT_EQ(found.terms[0].not_claimed, "");
  EXPECT_EQ(found.terms[1].not_claimed, "longer than the hold");
}

TEST(JointRelaxation, SaysWhatIsTooFastToBeSeen) {
  const auto truth = terms_of({{0.3, 0.05}, {0.3, 4.5}});
  const auto seen_from = [&](double speed_m_per_s) {
    return fit_press_and_hold(pressed(truth, speed_m_per_s, 50.0, 10.0, 4e-3).view())
        .seen_from_s;
  };
  EXPECT_GT(seen_from(5e-4), 0.05);  // dies away within the slow press
  EXPECT_LT(seen_from(5e-2), 0.05);
}

TEST(JointRelaxation, TellsWhatAHoldShowsAfterAnyPress) {
  const auto truth = terms_of({{0.26, 0.42}, {0.30, 4.5}});
  const JointRelaxation found =
      fit_press_and_hold(pressed(truth, 2e-3, 50.0, 15.0).view());
  for (const double speed : {5e-4, 5e-2}) {
    const Pressed other = pressed(truth, speed, 500.0, 10.0);
    const auto at = [&](double time_s) {
      const auto row = other.hold_begin + static_cast<std::size_t>(500.0 * time_s);
      return other.force_n[row] - 0.02;
    };
    EXPECT_NEAR(held_share(found, speed, 5.0), at(5.0) / at(0.0), 0.005) << speed;
  }
}

TEST(JointRelaxation, AddsAReleaseThatFollowsAndLeavesOutOneThatDoesNot) {
  const auto truth = terms_of({{0.26, 0.42}, {0.30, 4.5}});
  Pressed p = pressed(truth, 2e-3, 50.0, 10.0, 2e-3, 0.8);
  EXPECT_TRUE(fit_press_and_hold(p.view()).release);
  for (std::size_t i = p.hold_end; i < p.force_n.size(); ++i) {
    p.force_n[i] -= 0.2;  // sticks
  }
  const JointRelaxation found = fit_press_and_hold(p.view());
  EXPECT_FALSE(found.release);
  EXPECT_NEAR(found.release_rms_relative, 0.2 / 1.6, 0.05);
  expect_terms(found, truth, 0.1);
}

TEST(JointRelaxation, IsRefusedWithoutAPressThatCanBeFollowed) {
  const Pressed p = pressed(terms_of({{0.4, 1.5}}), 1.0, 100.0, 5.0);
  EXPECT_NE(fit_press_and_hold(p.view()).refused.find("samples in the press"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate
