// Shares of nodes where materials relax differently.
#include "precompute/press/relaxation_shares.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/obj_writer.h"
#include "precompute/material/material_spectrum.h"
#include "precompute/press/own_mesh_press.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

TEST(FitShares, FindsTheSharesThatThereAre) {
  const std::vector<double> tau_s{0.3, 2.0, 20.0};
  const std::vector<double> rate_per_s = fitted_rates_per_s(tau_s);
  const Eigen::RowVector3d g(0.2, 0.0, 0.35);
  Eigen::VectorXd share(std::ssize(rate_per_s));
  for (Eigen::Index i = 0; i < share.size(); ++i) {
    share[i] = 1.0;
    for (std::size_t k = 0; k < 3; ++k) {
      share[i] -= g[static_cast<Eigen::Index>(k)] *
                  relaxed_part(tau_s[k], rate_per_s[static_cast<std::size_t>(i)]);
    }
  }
  const FittedShares fit = fit_shares(tau_s, rate_per_s, share);
  EXPECT_LT((fit.g - g).norm(), 1e-9);
  EXPECT_LT(fit.rms, 1e-12);
}

TEST(FitShares, AreNeverNegative) {
  const std::vector<double> tau_s{0.3, 2.0};
  const std::vector<double> rate_per_s = fitted_rates_per_s(tau_s);
  // A force that grows while held is no relaxation: no share is best.
  const Eigen::VectorXd growing =
      Eigen::VectorXd::LinSpaced(std::ssize(rate_per_s), 1.01, 1.1);
  EXPECT_EQ(fit_shares(tau_s, rate_per_s, growing).g.maxCoeff(), 0.0);
  // Relaxing that is faster than both times: the shorter one takes it all.
  const Eigen::VectorXd early = Eigen::VectorXd::Constant(std::ssize(rate_per_s), 0.6);
  const FittedShares fit = fit_shares(tau_s, rate_per_s, early);
  EXPECT_GT(fit.g[0], 0.35);
  EXPECT_EQ(fit.g[1], 0.0);
  EXPECT_GT(fit.rms, 0.05);
}

// Two springs in series, one of which relaxes: force at a held length, in small steps.
// The spring k1 bears F = k1 (x1 - z), dz/dt of its own Maxwell memory.
double series_share(double ratio, double g, double tau_s, double time_s) {
  constexpr int kSteps = 20000;
  const double h = time_s / kSteps;
  double q = 0.0;  // relaxed strain of the first, d_1 = strain of the first
  double d1 = ratio / (1.0 + ratio);  // of a length of 1; stiffness 1 and `ratio`
  const double start = d1;
  for (int i = 0; i < kSteps; ++i) {
    q += (d1 - q) * -std::expm1(-h / tau_s);
    // d1 - g q = ratio (1 - d1)
    d1 = (ratio + g * q) / (1.0 + ratio);
  }
  return (d1 - g * q) / start;
}

TEST(FitShares, OfTwoMaterialsInSeriesAreRightWithinOnePercent) {
  double worst = 0.0;
  for (const double ratio : {0.3, 1.0, 3.0}) {
    Scene scene;
    scene.material.resize(2);
    scene.material[0].youngs_modulus_pa = 1.0;
    scene.material[0].relaxation = {{0.5}, {4.5}};
    scene.material[1].youngs_modulus_pa = ratio;
    const std::vector<double> tau_s = spectrum_of(scene).tau_s;
    const std::vector<double> rate_per_s = fitted_rates_per_s(tau_s);
    Eigen::VectorXd share(std::ssize(rate_per_s));
    for (Eigen::Index i = 0; i < share.size(); ++i) {
      const double k1 =
          transformed_scene(scene, rate_per_s[static_cast<std::size_t>(i)])
              .material[0]
              .youngs_modulus_pa;
      share[i] = k1 * (1.0 + ratio) / (k1 + ratio);
    }
    const FittedShares fit = fit_shares(tau_s, rate_per_s, share);
    for (const double t : {0.2, 1.0, 3.0, 10.0, 20.0}) {
      double rendered = 1.0;
      for (std::size_t k = 0; k < tau_s.size(); ++k) {
        rendered += fit.g[static_cast<Eigen::Index>(k)] * std::expm1(-t / tau_s[k]);
      }
      worst = std::max(worst, std::abs(rendered - series_share(ratio, 0.5, 4.5, t)));
    }
  }
  EXPECT_LT(worst, 0.01);
}

class RelaxationShares : public testing::Test {
 protected:
  // A ball of a soft material that relaxes around one that does not.
  RelaxationShares() {
    write_obj(sphere_surface(Eigen::Vector3d::Zero(), 0.05, 0.02), folder_ / "ball.obj",
              "a test");
    std::ofstream(folder_ / "scene.toml")
        << "[body]\nmesh = \"ball.obj\"\nlength_unit = \"m\"\n"
           "[[inclusion]]\nname = \"core\"\n"
           "sphere = { center_m = [0, 0, 0.033], radius_m = 0.015 }\n"
           "[[material]]\nregion = \"body\"\nlaw = \"linear\"\n"
           "youngs_modulus_pa = 5000.0\npoissons_ratio = 0.4\n"
           "relaxation = { g = [0.6], tau_s = [2] }\n"
           "[[material]]\nregion = \"core\"\nlaw = \"linear\"\n"
           "youngs_modulus_pa = 20000.0\npoissons_ratio = 0.4\n"
           "[[support]]\nbox_m = [[-1, -1, -1], [1, 1, -0.03]]\nkind = \"fixed\"\n"
           "[[tool]]\nname = \"ball\"\nshape = \"sphere\"\nradius_m = 0.01\n"
           "[reach]\ndepth_max_m = 0.004\n"
           "[accuracy]\nforce_relative = 0.2\ndepths = 5\n";
    scene_ = read_scene(folder_ / "scene.toml");
  }

  ScratchFolder folder_;
  Scene scene_;
};

double force_n(const Scene& scene, const BodySource& source, std::int32_t vertex) {
  BodySource body = source;
  body.material = materials_of(scene);
  const std::int32_t vertices[] = {vertex};
  const auto pressed = press_on_own_mesh(scene, body, body.tool.front(), vertices,
                                         contact_focus(scene, body), PressMode{});
  return pressed.front().indentation.sample.back().force_n.norm();
}

TEST_F(RelaxationShares, AreLessWherePartOfTheBodyDoesNotRelax) {
  const BodySource body = read_body(scene_);
  Eigen::Index top = 0;
  Eigen::Index side = 0;
  body.surface.position_m.col(2).maxCoeff(&top);
  body.surface.position_m.col(0).maxCoeff(&side);
  std::vector<std::vector<std::int32_t>> vertices{
      {static_cast<std::int32_t>(std::min(top, side)),
       static_cast<std::int32_t>(std::max(top, side))}};
  const std::vector<std::int32_t> reachable = reachable_vertices(scene_, body);
  const PressStrategy strategy = choose_strategy(scene_, body, reachable);
  Progress silent(nullptr);
  const auto tables = relaxation_shares(scene_, body, strategy, vertices,
                                        spectrum_of(scene_).tau_s, silent);
  ASSERT_EQ(tables.size(), 1U);
  const Viscoelasticity& shares = tables.front();
  EXPECT_EQ(shares.g.rows(), body.surface.position_m.rows());
  const std::int64_t other = top != 0 && side != 0 ? 0 : 1;
  EXPECT_NEAR(shares.shares(other).sum(),
              0.5 * (shares.shares(top).sum() + shares.shares(side).sum()), 1e-6);
  EXPECT_NEAR(shares.shares(side).sum(), 0.6, 0.005);
  EXPECT_LT(shares.shares(top).sum(), 0.5);
  EXPECT_GT(shares.shares(top).sum(), 0.3);
  // Presses of its own at a rate that was not fitted.
  const double rate_per_s = 0.6;
  const double ratio = force_n(transformed_scene(scene_, rate_per_s), body,
                               static_cast<std::int32_t>(top)) /
                       force_n(scene_, body, static_cast<std::int32_t>(top));
  double share = 1.0;
  for (std::size_t k = 0; k < shares.tau_s.size(); ++k) {
    share -= shares.shares(top)[static_cast<Eigen::Index>(k)] *
             relaxed_part(shares.tau_s[k], rate_per_s);
  }
  EXPECT_NEAR(share, ratio, 0.01);
  EXPECT_GT(shares.error_relative[static_cast<std::size_t>(top)], 0.0F);
  EXPECT_LT(shares.error_relative[static_cast<std::size_t>(top)], 0.03F);
}

}  // namespace
}  // namespace palpate
