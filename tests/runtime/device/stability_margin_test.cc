#include "runtime/device/stability_margin.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

constexpr DeviceLimits kDevice = {.damping_n_s_per_m = 0.5,
                                  .coulomb_n = 0.02,
                                  .resolution_m = 1e-5,
                                  .delay_s = 1e-3,
                                  .force_max_n = 8.0};

TEST(StabilityBounds, AreTheClosedForms) {
  const StabilityBounds bounds = stability_bounds(kDevice, 1e-3);
  EXPECT_DOUBLE_EQ(bounds.passivity_n_per_m, 250.0);
  EXPECT_DOUBLE_EQ(bounds.sampling_n_per_m, 1000.0);
  EXPECT_DOUBLE_EQ(bounds.delay_n_per_m, 0.5 / 1.5e-3);
  EXPECT_DOUBLE_EQ(bounds.quantisation_n_per_m, 4000.0);
  EXPECT_DOUBLE_EQ(bounds.renderable_n_per_m(), 0.5 / 1.5e-3);
}

TEST(StabilityBounds, KnowNoQuantisationWithoutAStep) {
  DeviceLimits device = kDevice;
  device.resolution_m = 0.0;
  device.delay_s = 0.0;
  const StabilityBounds bounds = stability_bounds(device, 1e-3);
  EXPECT_TRUE(std::isinf(bounds.quantisation_n_per_m));
  EXPECT_DOUBLE_EQ(bounds.delay_n_per_m, bounds.sampling_n_per_m);
}

TEST(RenderedStiffness, IsTheLargestSlopeAndTheFrictionSpringAtTheLargestForce) {
  const auto force = [](Eigen::Index node, double d) {
    return (node == 7 ? 400.0 : 100.0) * d;
  };
  const ResponseDatabase database =
      sample_database(plate(0.1, 4), ball(0.005, 0.5, 1e-3), force, 0.01);
  const RenderedStiffness stiffness = rendered_stiffness(database.tools[0], 3.0);
  EXPECT_NEAR(stiffness.normal_n_per_m, 400.0, 1e-9);
  EXPECT_EQ(stiffness.node, 7);
  EXPECT_NEAR(stiffness.friction_n_per_m, 0.5 * 3.0 / 1e-3, 1e-9);
  EXPECT_EQ(stiffness.largest_n_per_m(), stiffness.friction_n_per_m);
}

// Tip and shaft of a needle are felt together, along one axis.
TEST(RenderedStiffness, IsOfANeedlesTipAndShaftTogether) {
  ResponseDatabase database = sample_database(
      plate(0.1, 4), ball(0.0005, 0.0, 0.0),
      [](Eigen::Index /*node*/, double d) {
        return 100.0 * d;
      },
      0.01);
  EXPECT_NEAR(rendered_stiffness(database.tools[0], 3.0).largest_n_per_m(), 100.0,
              1e-9);
  database.tools[0].puncture.shaft_n_per_m = 60.0;
  const RenderedStiffness stiffness = rendered_stiffness(database.tools[0], 3.0);
  EXPECT_NEAR(stiffness.normal_n_per_m, 100.0, 1e-9);
  EXPECT_NEAR(stiffness.largest_n_per_m(), 160.0, 1e-9);
}

// Across the axis acts the shaft that is inserted, as much as the body has room for.
TEST(RenderedStiffness, IsThatAcrossAShaftWhereItIsLarger) {
  ResponseDatabase database = sample_database(
      plate(0.1, 4), ball(0.0005, 0.0, 0.0),
      [](Eigen::Index /*node*/, double d) {
        return 100.0 * d;
      },
      0.01);
  Puncture& puncture = database.tools[0].puncture;
  puncture.shaft_n_per_m = 60.0;
  puncture.lateral_n_per_m2 = 12000.0;
  EXPECT_EQ(rendered_stiffness(database.tools[0], 3.0).lateral_n_per_m, 0.0);
  puncture.insertable_m = 0.012;
  EXPECT_NEAR(rendered_stiffness(database.tools[0], 3.0).largest_n_per_m(), 160.0,
              1e-9);
  puncture.insertable_m = 0.03;
  const RenderedStiffness stiffness = rendered_stiffness(database.tools[0], 3.0);
  EXPECT_NEAR(stiffness.lateral_n_per_m, 360.0, 1e-9);
  EXPECT_EQ(stiffness.largest_n_per_m(), stiffness.lateral_n_per_m);
  const std::string why =
      why_not_renderable(stiffness, stability_bounds(kDevice, 1e-3), kDevice, 1e-3);
  EXPECT_NE(why.find("360 N/m across a needle's shaft, inserted as far as the body has "
                     "room, exceeds 333.3 N/m"),
            std::string::npos)
      << why;
}

TEST(MarginTable, GivesAVerdictOnEveryBound) {
  const StabilityBounds bounds = stability_bounds(kDevice, 1e-3);
  const std::string table = margin_table(bounds, 500.0);
  const auto row = [&](const std::string& bound) {
    const std::size_t begin = table.find(bound);
    return begin == std::string::npos
               ? ""
               : table.substr(begin, table.find('\n', begin) - begin);
  };
  EXPECT_NE(row("(8), B > 2 T J").find("250       0.5  not held, sufficient only"),
            std::string::npos)
      << table;
  EXPECT_NE(row("Colgate").find("1000         2  held"), std::string::npos) << table;
  EXPECT_NE(row("Diolaiti").find("333.3     0.667  BROKEN"), std::string::npos);
  EXPECT_NE(row("Abbott").find("4000         8  held"), std::string::npos);
  EXPECT_NE(margin_table(bounds, 200.0).find("1.25  held"), std::string::npos);
}

TEST(WhyNotRenderable, NamesTheBoundThatIsBroken) {
  const StabilityBounds bounds = stability_bounds(kDevice, 1e-3);
  EXPECT_EQ(
      why_not_renderable({.normal_n_per_m = 300.0, .node = 4}, bounds, kDevice, 1e-3),
      "");
  const std::string damping =
      why_not_renderable({.normal_n_per_m = 400.0, .node = 4}, bounds, kDevice, 1e-3);
  EXPECT_NE(damping.find("400 N/m (node 4) exceeds 333.3 N/m, what a damping of 0.5"),
            std::string::npos);
  DeviceLimits coarse = kDevice;
  coarse.resolution_m = 1e-3;
  const std::string step =
      why_not_renderable({.normal_n_per_m = 1.0, .friction_n_per_m = 50.0},
                         stability_bounds(coarse, 1e-3), coarse, 1e-3);
  EXPECT_NE(step.find("friction before sliding exceeds 40 N/m, what a position step"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate
