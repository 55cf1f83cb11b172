// A body whose stiffness is known everywhere, measured at scattered points.
#include "fitting/surface/field_fit.h"

#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fitting/surface/geodesic_distance.h"
#include "formats/base/error.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

constexpr double kBodyRadius = 0.05;
constexpr double kDepth = 4e-3;

// [N/m^1.5] of the sphere's surface at p.
double coefficient(const Eigen::Vector3d& p) {
  return 4000.0 * std::exp(0.5 * std::sin(30.0 * p.x()) + 10.0 * p.z());
}

Measurement pressed(double K, std::mt19937& generator) {
  std::normal_distribution<double> noise(0.0, 0.004);
  Measurement m;
  for (int i = 0; i < 120; ++i) {
    const double x = 5.5e-3 * i / 119.0;
    const double d = std::max(0.0, x - 1.2e-3);
    m.depth_m.push_back(x);
    m.force_n.push_back(K * std::pow(d, 1.5) + noise(generator));
  }
  return m;
}

std::vector<SurfaceProbe> probes_of_sphere() {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal;
  std::vector<SurfaceProbe> probes;
  for (int i = 0; i < 60; ++i) {
    Eigen::Vector3d p(normal(generator), normal(generator), normal(generator));
    p = kBodyRadius * p.normalized();
    SurfaceProbe probe;
    probe.name = fmt::format("probe {}", i);
    probe.position_m = p;
    const double factor = i == 11 ? 5.0 : i == 30 ? 0.2 : 1.0;
    probe.measurement = pressed(factor * coefficient(p), generator);
    probe.approach = select_approach(probe.measurement);
    probe.fit = fit_contact(probe.approach);
    probes.push_back(std::move(probe));
  }
  return probes;
}

// Probes are fitted once, and so is the surface through all of them.
class MeasuredSphere : public testing::Test {
 protected:
  static const std::vector<SurfaceProbe>& fitted_probes() {
    static const std::vector<SurfaceProbe> probes = probes_of_sphere();
    return probes;
  }
  const SurfaceFit& plain_fit() const {
    static const SurfaceFit fit = fit_surface(body_, tool_, fitted_probes());
    return fit;
  }

  SurfaceMesh body_ = sphere_surface(kBodyRadius, 2);
  ToolShape tool_ = ball(5e-3, 0.2, 1e-4);
  std::vector<SurfaceProbe> probes_ = fitted_probes();
};

TEST_F(MeasuredSphere, GivesEveryNodeItsForceWithinTheStatedError) {
  const SurfaceFit& fit = plain_fit();
  check(fit.database);
  const ResponseTable& table = fit.database.tools.at(0);
  double covered = 0.0;
  double squares = 0.0;
  for (Eigen::Index i = 0; i < body_.position_m.rows(); ++i) {
    const CurveView curve = table.curve(i);
    const double depth_m = curve.depth_m.back();
    EXPECT_NEAR(depth_m, kDepth, 5e-4);
    const double truth = coefficient(body_.position_m.row(i)) * std::pow(depth_m, 1.5);
    const double off = std::log(curve.force_n.back() / truth);
    squares += off * off;
    covered += std::abs(off) <= 1.96 * table.error_relative[static_cast<std::size_t>(i)]
                   ? 1.0
                   : 0.0;
  }
  const auto n = static_cast<double>(body_.position_m.rows());
  EXPECT_LT(std::sqrt(squares / n), 0.12);  // the field's own spread is 0.45
  EXPECT_GT(covered / n, 0.85);  // one draw: errors of neighbours go together
  EXPECT_EQ(fit.report.far_nodes, 0U);
}

TEST_F(MeasuredSphere, ListsTheGlitchedProbesAndKeepsTheirCurves) {
  const SurfaceFit& fit = plain_fit();
  ASSERT_EQ(fit.report.left_out.size(), 2U) << describe(fit.report);
  for (const LeftOutProbe& probe : fit.report.left_out) {
    EXPECT_TRUE(probe.name == "probe 11" || probe.name == "probe 30") << probe.name;
  }
  EXPECT_EQ(fit.report.probes, 58U);
  EXPECT_EQ(fit.database.measurement.run_name.size(), 60U);
  EXPECT_EQ(fit.database.measurement.depth_m.size(), 60U * 120U);
}

// Probes in noise: their deepest forces are known, their shallowest not.
TEST_F(MeasuredSphere, CountsEveryRunOnce) {
  std::mt19937 generator(21);
  for (std::size_t i = 0; i < 4; ++i) {
    SurfaceProbe& probe = probes_[i];
    Measurement noisy = pressed(coefficient(probe.position_m), generator);
    std::normal_distribution<double> noise(0.0, 0.06);
    for (double& force_n : noisy.force_n) {
      force_n += noise(generator);
    }
    probe.measurement = noisy;
    probe.approach = select_approach(noisy);
    probe.fit = fit_contact(probe.approach);
  }
  const SurfaceFitReport report = fit_surface(body_, tool_, probes_).report;
  EXPECT_EQ(report.runs, 60U);
  EXPECT_EQ(report.probes + report.left_out.size(), 60U) << describe(report);
  EXPECT_NE(describe(report).find("60 runs read"), std::string::npos);
}

TEST_F(MeasuredSphere, PredictsLeftOutProbesBetterThanTheNearest) {
  const SurfaceFit& fit = plain_fit();
  const DepthScore& deepest = fit.report.depth.back();
  EXPECT_LT(2.0 * deepest.rms, deepest.nearest_rms);
  EXPECT_GT(deepest.coverage, 0.85);
}

TEST_F(MeasuredSphere, JoinsRepeatsAndTellsThemFromRoughness) {
  std::mt19937 generator(3);
  std::normal_distribution<double> normal;
  std::vector<SurfaceProbe> repeated;
  for (std::size_t i = 40; i < 60; ++i) {  // 20 places, 3 presses each
    const double place = std::exp(0.15 * normal(generator));
    for (int k = 0; k < 3; ++k) {
      SurfaceProbe probe = probes_[i];
      probe.name += fmt::format(" press {}", k);
      const double press = std::exp(0.05 * normal(generator));
      probe.measurement =
          pressed(place * press * coefficient(probe.position_m), generator);
      probe.approach = select_approach(probe.measurement);
      probe.fit = fit_contact(probe.approach);
      repeated.push_back(std::move(probe));
    }
  }
  const SurfaceFit fit = fit_surface(body_, tool_, repeated);
  EXPECT_EQ(fit.report.probes + fit.report.left_out.size(), 60U);
  EXPECT_EQ(fit.report.places, 20U) << describe(fit.report);
  EXPECT_NEAR(fit.report.repeatability, 0.05, 0.02);
}

TEST_F(MeasuredSphere, FlagsNodesFarFromEveryProbe) {
  std::erase_if(probes_, [](const SurfaceProbe& probe) {
    return probe.position_m.x() < 0.0;
  });
  // Short waves, so that the far side is many lengths away.
  const SurfaceFit fit = fit_surface(body_, tool_, probes_);
  const ResponseTable& table = fit.database.tools.at(0);
  std::vector<AttachedPoint> points;
  for (const SurfaceProbe& probe : probes_) {
    points.push_back(closest_surface_point(body_, probe.position_m));
  }
  const Eigen::VectorXd away_m = geodesic_distance_m(body_, points);
  const double limit_m = 2.0 * fit.report.parameters.parameters.length_m;
  for (std::size_t i = 0; i < table.flags.size(); ++i) {
    if ((table.flags[i] & kExtrapolated) == 0) {  // glitched probes are no measurement
      EXPECT_LE(away_m[static_cast<Eigen::Index>(i)], limit_m);
    }
  }
  // Error bars open where nobody measured.
  Eigen::Index back = 0;
  Eigen::Index front = 0;
  body_.position_m.col(0).minCoeff(&back);
  body_.position_m.col(0).maxCoeff(&front);
  EXPECT_GT(table.error_relative[static_cast<std::size_t>(back)],
            2.0 * table.error_relative[static_cast<std::size_t>(front)]);
}

TEST_F(MeasuredSphere, DirectionsFollowTheProbes) {
  const auto tilted = [](const Eigen::Vector3d& p) {
    return (p.normalized() + 0.2 * Eigen::Vector3d::UnitX()).normalized();
  };
  for (SurfaceProbe& probe : probes_) {
    probe.direction = tilted(probe.position_m);
  }
  const SurfaceFit fit = fit_surface(body_, tool_, probes_);
  const Points& direction = fit.database.tools.at(0).direction;
  double worst = 0.0;
  for (Eigen::Index i = 0; i < direction.rows(); ++i) {
    worst = std::max(worst, (direction.row(i).transpose() -
                             tilted(body_.position_m.row(i).transpose()))
                                .norm());
  }
  EXPECT_LT(worst, 0.1);  // half of the tilt; the bare normals miss all of it
}

// F = c(p) (0.3 u + 0.7 (exp(5 u) - 1) / (exp(5) - 1)), u the depth over 4.3 mm.
double linear_exponential(double depth_m) {
  const double u = std::max(0.0, depth_m) / 4.3e-3;
  return 0.3 * u + 0.7 * std::expm1(5.0 * u) / std::expm1(5.0);
}

double smooth_force_n(const Eigen::Vector3d& p, double depth_m) {
  return 2.0 * std::exp(8.0 * p.z()) * linear_exponential(depth_m);
}

// Mean over the nodes of log force off the truth, worst of depths beyond a quarter.
double worst_bias(const SurfaceMesh& body, const ResponseTable& table) {
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(kCommonDepths + 1);
  for (Eigen::Index i = 0; i < body.position_m.rows(); ++i) {
    const CurveView curve = table.curve(i);
    for (std::size_t k = kCommonDepths / 2; k < curve.depth_m.size(); ++k) {
      sum[static_cast<Eigen::Index>(k)] += std::log(
          curve.force_n[k] / smooth_force_n(body.position_m.row(i), curve.depth_m[k]));
    }
  }
  return (sum / static_cast<double>(body.position_m.rows())).abs().maxCoeff();
}

TEST_F(MeasuredSphere, TakesTheLawThatFitsEachProbe) {
  std::mt19937 generator(9);
  std::normal_distribution<double> noise(0.0, 0.002);
  for (SurfaceProbe& probe : probes_) {
    Measurement& m = probe.measurement;
    for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
      m.force_n[i] =
          smooth_force_n(probe.position_m, m.depth_m[i] - 1.2e-3) + noise(generator);
    }
    probe.approach = select_approach(m, {}, FitRange{0.0, 1e-3});
    probe.fit = fit_contact(probe.approach);
  }
  const double power_law =
      worst_bias(body_, fit_surface(body_, tool_, probes_).database.tools.at(0));
  for (SurfaceProbe& probe : probes_) {
    probe.curve =
        fit_families(probe.approach, probe.fit, {"power-law", "linear-exponential"},
                     "aicc", {.cross_validate = false})
            .fits.at(0);
  }
  const SurfaceFit fit = fit_surface(body_, tool_, probes_);
  EXPECT_GE(fit.report.laws.at("linear-exponential"), 55U);
  // The nodes' errors are a few hundredths; those of a wrong law do not average out.
  EXPECT_LT(worst_bias(body_, fit.database.tools.at(0)), 0.03);
  EXPECT_GT(power_law, 0.06);
}

// Of a press at 2 mm/s; the amplitudes' scatter has median 1.
Relaxation relaxing_hold(double amplitude, double seconds) {
  Relaxation r;
  r.g = {0.25 * amplitude, 0.15 * amplitude};
  r.tau_s = {0.4, 5.0};
  r.seconds = seconds;
  r.speed_m_per_s = 2e-3;
  r.converged = true;
  return r;
}

TEST_F(MeasuredSphere, KeepsEachProbesRelaxationAndTheMedianAtTheNodes) {
  for (std::size_t i = 0; i < 9; ++i) {
    const double off = 0.1 * (static_cast<double>(i) - 4.0);
    probes_[i].relaxation =
        relaxing_hold(1.0 + off * off * off, 10.0 + static_cast<double>(i));
  }
  probes_[9].relaxation = relaxing_hold(2.0, 1.0);  // too short to be compared
  const SurfaceFit fit = fit_surface(body_, tool_, probes_);
  check(fit.database);
  const ResponseRelaxation& nodes = fit.database.tools.at(0).relaxation;
  ASSERT_EQ(nodes.terms.size(), 1U);
  EXPECT_EQ(nodes.probes, 9);
  EXPECT_EQ(nodes.seconds, 10.0);
  EXPECT_EQ(nodes.speed_m_per_s, 2e-3);
  EXPECT_NEAR(nodes.terms.g_1[0], 0.25, 1e-4);
  EXPECT_NEAR(nodes.terms.g_2[0], 0.15, 1e-4);
  EXPECT_NEAR(nodes.terms.tau_1_s[0], 0.4, 1e-3);
  EXPECT_NEAR(nodes.terms.tau_2_s[0], 5.0, 1e-2);
  const RunRelaxation& runs = fit.database.measurement.relaxation;
  ASSERT_EQ(runs.terms.size(), probes_.size());
  EXPECT_EQ(runs.terms.g_1[9], 0.5);
  EXPECT_EQ(runs.seconds[8], 18.0);
  EXPECT_TRUE(std::isnan(runs.terms.g_1[10]));
}

// Also fitted together with its press, which tells the terms to 0.01.
Relaxation hold_with_press(double g_1, double g_2, double seconds) {
  Relaxation hold = relaxing_hold(1.0, seconds);
  hold.joint.refused.clear();
  hold.joint.terms.resize(2);
  hold.joint.terms[0].g = g_1;
  hold.joint.terms[0].tau_s = 0.3;
  hold.joint.terms[1].g = g_2;
  hold.joint.terms[1].tau_s = 4.0;
  hold.joint.covariance = 1e-4 * Eigen::MatrixXd::Identity(4, 4);
  hold.joint.displacement_m = {0.0, 1e-3};
  hold.joint.force_n = {0.0, 1.0};
  return hold;
}

// Press and hold fitted together say how the material relaxes: that is rendered.
TEST_F(MeasuredSphere, GivesTheDatabaseTheMaterialsRelaxation) {
  for (std::size_t i = 0; i < 9; ++i) {
    const double off = 0.1 * (static_cast<double>(i) - 4.0);
    probes_[i].relaxation = hold_with_press(0.30 * (1.0 + off), 0.20 * (1.0 + off),
                                            10.0 + static_cast<double>(i));
  }
  const SurfaceFit fit = fit_surface(body_, tool_, probes_);
  check(fit.database);
  const ResponseTable& table = fit.database.tools.at(0);
  EXPECT_TRUE(table.relaxation.empty());
  const Viscoelasticity& rendered = table.viscoelasticity;
  ASSERT_EQ(rendered.terms(), 2);
  EXPECT_FALSE(rendered.instantaneous);
  EXPECT_EQ(rendered.probes, 9);
  EXPECT_EQ(rendered.speed_m_per_s, 2e-3);
  EXPECT_NEAR(rendered.g(0, 0), 0.30F, 1e-3F);
  EXPECT_NEAR(rendered.g(0, 1), 0.20F, 1e-3F);
  EXPECT_NEAR(rendered.tau_s[0], 0.3, 2e-3);
  EXPECT_NEAR(rendered.tau_s[1], 4.0, 4e-2);
  EXPECT_FALSE(rendered.sites.empty());
  EXPECT_NE(describe(fit.report).find("holds at 9 places, a field needs 20"),
            std::string::npos)
      << describe(fit.report);
  // Most holds must have been fitted so.
  for (std::size_t i = 0; i < 5; ++i) {
    probes_[i].relaxation->joint.refused = "none";
  }
  EXPECT_TRUE(
      fit_surface(body_, tool_, probes_).database.tools.at(0).viscoelasticity.empty());
}

TEST_F(MeasuredSphere, GivesNodesRelaxationOfTheirOwnWhereTheyDiffer) {
  std::mt19937 generator(2);
  std::normal_distribution<double> noise(0.0, 0.06);
  for (SurfaceProbe& probe : probes_) {
    const double g = probe.position_m.y() < 0.0 ? 0.1 : 0.3;
    probe.relaxation =
        hold_with_press(g + noise(generator), 0.2 + noise(generator), 10.0);
  }
  const SurfaceFit fit = fit_surface(body_, tool_, probes_);
  check(fit.database);
  const Viscoelasticity& rendered = fit.database.tools.at(0).viscoelasticity;
  ASSERT_EQ(rendered.g.rows(), body_.position_m.rows()) << describe(fit.report);
  EXPECT_EQ(rendered.error_relative.size(),
            static_cast<std::size_t>(body_.position_m.rows()));
  EXPECT_FALSE(rendered.sites.empty());
  Eigen::Index low = 0, high = 0;
  body_.position_m.col(1).minCoeff(&low);
  body_.position_m.col(1).maxCoeff(&high);
  EXPECT_NEAR(rendered.g(low, 0), 0.1F, 0.05F);
  EXPECT_NEAR(rendered.g(high, 0), 0.3F, 0.05F);
  EXPECT_NEAR(rendered.g(low, 1), 0.2F, 0.05F);
  EXPECT_NE(describe(fit.report).find("relaxation of the nodes: a field"),
            std::string::npos);
}

TEST_F(MeasuredSphere, SaysNothingOfRelaxationWithoutHolds) {
  const SurfaceFit& fit = plain_fit();
  EXPECT_TRUE(fit.database.tools.at(0).relaxation.empty());
  EXPECT_EQ(fit.database.measurement.relaxation.terms.size(), 0U);
}

TEST_F(MeasuredSphere, RefusesWhatItCannotPlace) {
  std::vector<SurfaceProbe> few(probes_.begin(), probes_.begin() + 5);
  EXPECT_THROW((void)fit_surface(body_, tool_, few), InputError);
  probes_[3].position_m *= 1000.0;  // millimetres
  EXPECT_THROW((void)fit_surface(body_, tool_, probes_), InputError);
}

}  // namespace
}  // namespace palpate
