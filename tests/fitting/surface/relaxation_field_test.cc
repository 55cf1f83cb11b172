// A body whose relaxation is known at every place, from what holds say of it.
#include "fitting/surface/relaxation_field.h"

#include <cmath>
#include <functional>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fitting/surface/held_shares.h"
#include "fitting/surface/probe_relaxation.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

constexpr double kSphereRadius = 0.05, kHold = 10.0;
const std::vector<double> kTau{0.4, 4.0};

using TermsAt = std::function<Eigen::Vector2d(const Eigen::Vector3d&)>;

Eigen::Vector2d halves(const Eigen::Vector3d& p) {
  return p.x() < 0.0 ? Eigen::Vector2d(0.15, 0.10) : Eigen::Vector2d(0.26, 0.30);
}

// A hold that tells both g with independent errors.
Relaxation hold_of(const Eigen::Vector2d& g, double sd) {
  Relaxation hold;
  hold.seconds = kHold;
  hold.speed_m_per_s = 1e-3;
  hold.joint.refused.clear();
  hold.joint.terms.resize(2);
  for (std::size_t k = 0; k < 2; ++k) {
    hold.joint.terms[k].g = g[static_cast<Eigen::Index>(k)];
    hold.joint.terms[k].tau_s = kTau[k];
  }
  hold.joint.covariance = Eigen::MatrixXd::Zero(4, 4);
  hold.joint.covariance.diagonal().head(2).setConstant(sd * sd);
  hold.joint.displacement_m = {0.0, 1e-3};
  hold.joint.force_n = {0.0, 1.0};
  return hold;
}

class HeldSphere : public testing::Test {
 protected:
  void hold(const TermsAt& terms, std::size_t count, double sd) {
    std::mt19937 generator(5);
    std::normal_distribution<double> normal;
    probes_.resize(count);
    for (SurfaceProbe& probe : probes_) {
      const Eigen::Vector3d p(normal(generator), normal(generator), normal(generator));
      probe.position_m = kSphereRadius * p.normalized();
      Eigen::Vector2d g = terms(probe.position_m);
      g += sd * Eigen::Vector2d(normal(generator), normal(generator));
      g = g.cwiseMax(0.0);
      probe.relaxation = hold_of(g / std::max(1.0, g.sum()), sd);
    }
  }
  [[nodiscard]] std::vector<const SurfaceProbe*> all() const {
    std::vector<const SurfaceProbe*> all;
    for (const SurfaceProbe& probe : probes_) {
      all.push_back(&probe);
    }
    return all;
  }
  [[nodiscard]] RelaxationField fit() const {
    return relaxation_field(body_, held_with_press(all()),
                            common_viscoelasticity(all()));
  }

  SurfaceMesh body_ = sphere_surface(kSphereRadius, 2);
  std::vector<SurfaceProbe> probes_;
};

TEST_F(HeldSphere, TwoHalvesAreRecoveredWithinTheStatedError) {
  hold(halves, 80, 0.01);
  const auto [found, report] = fit();
  ASSERT_TRUE(report.taken) << report.reason;
  ASSERT_EQ(found.g.rows(), body_.position_m.rows());
  ASSERT_EQ(found.error_relative.size(), static_cast<std::size_t>(found.g.rows()));
  const Eigen::MatrixXd of_terms = shares_of_terms(report.time_s, kTau);
  const double spacing_m =
      kSphereRadius * std::sqrt(4.0 * 3.14159265 / 80.0);  // of probes
  double covered = 0.0, away = 0.0, squares = 0.0;
  for (Eigen::Index i = 0; i < found.g.rows(); ++i) {
    const Eigen::Vector3d p = body_.position_m.row(i);
    const Eigen::VectorXd off = of_terms * (found.shares(i).transpose() - halves(p));
    const double error =
        static_cast<double>(found.error_relative[static_cast<std::size_t>(i)]);
    if (std::abs(p.x()) > spacing_m) {  // beside the edge no probe tells where it is
      covered += off.cwiseAbs().maxCoeff() <= 1.96 * error ? 1.0 : 0.0;
      squares += off.squaredNorm() / 2.0;
      away += 1.0;
    }
  }
  EXPECT_GT(covered / away, 0.9);              // one draw: neighbours err together
  EXPECT_LT(std::sqrt(squares / away), 0.03);  // the halves differ by 0.11 and 0.29
  EXPECT_NEAR(found.tau_s[0], kTau[0], 0.05 * kTau[0]);
  EXPECT_NEAR(found.tau_s[1], kTau[1], 0.05 * kTau[1]);
  EXPECT_LT(2.0 * report.field_rms, report.common_rms);
  EXPECT_NE(describe(report).find("a field"), std::string::npos) << describe(report);
}

TEST_F(HeldSphere, UniformBodyKeepsTheMedian) {
  hold(
      [](const Eigen::Vector3d&) {
        return Eigen::Vector2d(0.26, 0.30);
      },
      60, 0.02);
  const auto [found, report] = fit();
  EXPECT_FALSE(report.taken) << report.reason;
  EXPECT_EQ(found.g, common_viscoelasticity(all()).g);
  EXPECT_EQ(found.rule, common_viscoelasticity(all()).rule);
  EXPECT_EQ(found.error_relative.size(), 1U);
  EXPECT_NE(describe(report).find("the median for all"), std::string::npos);
}

TEST_F(HeldSphere, TooFewProbesKeepTheMedianAndSaySo) {
  hold(halves, kHeldPlacesMin - 1, 0.01);
  const auto [found, report] = fit();
  EXPECT_FALSE(report.taken);
  EXPECT_EQ(found.g.rows(), 1);
  EXPECT_EQ(report.reason, fmt::format("holds at {} places, a field needs {}",
                                       kHeldPlacesMin - 1, kHeldPlacesMin));
}

TEST_F(HeldSphere, RepeatsAtOnePlaceDoNotMakeMorePlaces) {
  hold(halves, kHeldPlacesMin - 1, 0.01);
  probes_.insert(probes_.end(), probes_.begin(), probes_.end());
  const auto [found, report] = fit();
  EXPECT_EQ(report.places, kHeldPlacesMin - 1);
  EXPECT_FALSE(report.taken);
}

TEST_F(HeldSphere, SharesStayInBoundsAtExtremes) {
  hold(
      [](const Eigen::Vector3d& p) {
        return p.z() < 0.0 ? Eigen::Vector2d(0.002, 0.0) : Eigen::Vector2d(0.6, 0.399);
      },
      60, 0.02);
  const auto [found, report] = fit();
  ASSERT_TRUE(report.taken) << report.reason;
  EXPECT_GE(found.g.minCoeff(), 0.0F);
  double most = 0.0;
  for (Eigen::Index i = 0; i < found.g.rows(); ++i) {
    most = std::max(most, found.shares(i).sum());
  }
  EXPECT_LE(most, 1.0 + 1e-6);  // of float
  EXPECT_GT(most, 0.95);
  EXPECT_LT(found.g.rowwise().sum().minCoeff(), 0.05F);
}

// The probe nearest to the pole of one half claims, with a large error,
// to relax as the other does.
TEST_F(HeldSphere, OneUncertainProbeChangesLittle) {
  hold(halves, 80, 0.01);
  std::size_t odd = 0;
  for (std::size_t i = 1; i < probes_.size(); ++i) {
    odd = probes_[i].position_m.x() < probes_[odd].position_m.x() ? i : odd;
  }
  Eigen::Index node = 0;
  (body_.position_m.rowwise() - probes_[odd].position_m.transpose())
      .rowwise()
      .squaredNorm()
      .minCoeff(&node);
  const double before = fit().relaxation.shares(node).sum();
  probes_[odd].relaxation = hold_of({0.20, 0.20}, 0.2);
  EXPECT_NEAR(fit().relaxation.shares(node).sum(), before, 0.02);
}

TEST(HeldShares, NearestTermsAreTheNearestOfAllThatMayBe) {
  const Eigen::MatrixXd of_terms = shares_of_terms(share_times_s(kTau, kHold), kTau);
  constexpr int kSteps = 400;
  for (const Eigen::Vector2d& shares :
       {Eigen::Vector2d(0.3, 0.5), Eigen::Vector2d(0.5, 0.3),
        Eigen::Vector2d(-0.1, 0.2), Eigen::Vector2d(-0.1, -0.2),
        Eigen::Vector2d(0.9, 1.3), Eigen::Vector2d(0.1, 1.0), Eigen::Vector2d(1.2, 0.9),
        Eigen::Vector2d(0.0, 0.3)}) {
    const Eigen::VectorXd g = nearest_terms(of_terms, shares);
    EXPECT_GE(g.minCoeff(), 0.0);
    EXPECT_LE(g.sum(), 1.0 + 1e-12);
    const double distance = (of_terms * g - shares).norm();
    double least = 1e9;
    for (int a = 0; a <= kSteps; ++a) {
      for (int b = 0; a + b <= kSteps; ++b) {
        const Eigen::Vector2d other = Eigen::Vector2d(a, b) / kSteps;
        least = std::min(least, (of_terms * other - shares).norm());
      }
    }
    EXPECT_LE(distance, least + 1e-12);
    EXPECT_NEAR(distance, least, 2.0 / kSteps);  // of_terms shortens; a cell's diagonal
  }
}

// Of independent errors e of both g: e sqrt(sum (1 - exp(-t / tau))^2).
TEST(HeldShares, CarryEachProbesOwnError) {
  SurfaceProbe sure, unsure, lost, silent;
  sure.relaxation = hold_of({0.2, 0.3}, 0.01);
  unsure.relaxation = hold_of({0.2, 0.3}, 0.1);
  lost.relaxation = hold_of({0.2, 0.3}, 1.0);
  silent.relaxation = hold_of({0.2, 0.3}, 0.01);
  silent.relaxation->joint.covariance.resize(0, 0);
  const std::vector<double> time_s = share_times_s(kTau, kHold);
  const auto data = held_shares({&sure, &unsure, &lost, &silent}, time_s);
  ASSERT_EQ(data.size(), 2U);
  for (Eigen::Index m = 0; m < 2; ++m) {
    const FieldData& set = data[static_cast<std::size_t>(m)];
    const Eigen::VectorXd slope = shares_of_terms(time_s, kTau).row(m);
    EXPECT_NEAR(set.value[0], slope.dot(Eigen::Vector2d(0.2, 0.3)), 1e-12);
    EXPECT_NEAR(set.sd[0], 0.01 * slope.norm(), 1e-12);
    EXPECT_NEAR(set.sd[1], 0.1 * slope.norm(), 1e-12);
    EXPECT_EQ(set.used, (std::vector<char>{1, 1, 0, 1}));
    EXPECT_EQ(set.sd[3], 1e-3);
  }
}

TEST(HeldShares, CommonTimesMissNothingOfProbesThatHaveThem) {
  SurfaceProbe same, other;
  same.relaxation = hold_of({0.2, 0.3}, 0.01);
  other.relaxation = hold_of({0.2, 0.3}, 0.01);
  other.relaxation->joint.terms[1].tau_s *= 2.0;
  EXPECT_NEAR(common_times_error({&same}, kTau, kHold), 0.0, 1e-12);
  EXPECT_GT(common_times_error({&same, &other}, kTau, kHold), 1e-3);
  const std::vector<double> off{0.5, 3.0};
  const std::vector<double> found = times_that_miss_least_s({&same}, off, kHold);
  EXPECT_NEAR(found[0], kTau[0], 2e-3 * kTau[0]);
  EXPECT_NEAR(found[1], kTau[1], 2e-3 * kTau[1]);
}

}  // namespace
}  // namespace palpate
