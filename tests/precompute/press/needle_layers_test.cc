// What needles meet below the nodes of a ball with a lump right under its top.
#include "precompute/press/needle_layers.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/obj_writer.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class NeedleLayersTest : public testing::Test {
 protected:
  Scene scene(const std::string& body, const std::string& lump,
              const std::string& tool) {
    write_obj(icosphere(0.03, 4), folder_ / "body.obj", "a body");
    std::ofstream(folder_ / "scene.toml") << R"([body]
mesh = "body.obj"
length_unit = "m"
[[inclusion]]
name = "lump"
sphere = { center_m = [0.0, 0.0, 0.02], radius_m = 0.009 }
[[material]]
region = "body"
law = "linear"
youngs_modulus_pa = 6000.0
poissons_ratio = 0.4
)" << body << R"(
[[material]]
region = "lump"
law = "linear"
youngs_modulus_pa = 60000.0
poissons_ratio = 0.4
)" << lump << R"(
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, -0.02]]
[[tool]]
name = "needle"
shape = "needle"
radius_m = 0.0005
edge_width_m = 0.0015
)" << tool << R"(
[[tool]]
name = "tip"
shape = "sphere"
radius_m = 0.01
[reach]
depth_max_m = 0.004
)";
    return read_scene(folder_ / "scene.toml");
  }

  std::vector<Puncture> of(const std::string& body, const std::string& lump,
                           const std::string& tool = "press_radius_m = 0.002") {
    const Scene read = scene(body, lump, tool);
    body_ = read_body(read);
    return needle_layers(read, body_);
  }

  // Node nearest to a place.
  [[nodiscard]] Eigen::Index node_at(const Eigen::RowVector3d& p_m) const {
    Eigen::Index node = 0;
    (body_.surface.position_m.rowwise() - p_m).rowwise().norm().minCoeff(&node);
    return node;
  }

  ScratchFolder folder_;
  BodySource body_;
};

constexpr const char* kSoft =
    "puncture = { toughness_j_per_m2 = 164.0, friction = 0.25, radial_stress_pa = "
    "200.0, "
    "static_ratio = 1.2, membrane_n = 0.5 }";
constexpr const char* kFirm =
    "puncture = { toughness_j_per_m2 = 1000.0, friction_n_per_m = 3.0 }";

TEST_F(NeedleLayersTest, ForcesAreToughnessTimesWidth) {
  const std::vector<Puncture> all = of(kSoft, kFirm);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_TRUE(all[1].empty());  // the other tool is no needle
  const Puncture& needle = all[0];
  ASSERT_EQ(needle.material, (std::vector<std::string>{"body", "lump"}));
  // Liver at 164 J/m^2, an edge of 1.5 mm: 0.25 N (Gokgol 2012).
  EXPECT_NEAR(needle.cutting_n[0], 0.246, 1e-12);
  EXPECT_NEAR(needle.cutting_n[1], 1.5, 1e-12);
  EXPECT_EQ(needle.membrane_n, (std::vector<double>{0.5, 1.5}));
  EXPECT_NEAR(needle.friction_n_per_m[0],
              0.25 * 200.0 * 2.0 * std::numbers::pi * 0.0005, 1e-12);
  EXPECT_EQ(needle.friction_n_per_m[1], 3.0);
  EXPECT_EQ(needle.static_ratio, (std::vector<double>{1.2, 1.0}));
  EXPECT_EQ(needle.rule, "force");
  EXPECT_NEAR(needle.lateral_n_per_m2, 0.65 * 6000.0 / (1.0 - 0.16), 1e-6);
  EXPECT_EQ(needle.mouth_m, 0.0005);
}

TEST_F(NeedleLayersTest, LayersBeginWhereTheAxisCrossesTheLump) {
  const Puncture needle = of(kSoft, kFirm)[0];
  ASSERT_EQ(needle.layer_depth_m.rows(), body_.normal.rows());
  const Eigen::Index top = node_at({0.0, 0.0, 0.03});
  ASSERT_EQ(needle.layer_depth_m.cols(), 3);
  EXPECT_EQ(needle.layer_depth_m(top, 0), 0.0);
  EXPECT_NEAR(needle.layer_depth_m(top, 1), 0.001, 2e-4);
  EXPECT_NEAR(needle.layer_depth_m(top, 2), 0.019, 2e-4);
  EXPECT_EQ(needle.layer_material(top, 0), 0);
  EXPECT_EQ(needle.layer_material(top, 1), 1);
  EXPECT_EQ(needle.layer_material(top, 2), 0);
  // From the side, the axis runs below the lump.
  const Eigen::Index side = node_at({0.03, 0.0, 0.0});
  EXPECT_TRUE(std::isnan(needle.layer_depth_m(side, 1)));
  EXPECT_EQ(needle.layer_material(side, 1), -1);
}

TEST_F(NeedleLayersTest, WhatHasNoPunctureCannotBeEntered) {
  const Puncture needle = of(kSoft, "")[0];
  EXPECT_EQ(needle.cutting_n[1], std::numeric_limits<double>::infinity());
  EXPECT_EQ(needle.membrane_n[1], std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(needle.toughness_j_per_m2[1]));
}

TEST_F(NeedleLayersTest, AMembraneMayBreakByEnergy) {
  const Puncture needle =
      of("puncture = { toughness_j_per_m2 = 100.0, membrane_j = 0.002 }", kFirm)[0];
  EXPECT_EQ(needle.rule, "energy");
  EXPECT_EQ(needle.rupture[0], 0.002);
}

TEST_F(NeedleLayersTest, AMembraneBelowTheSurfaceMayBreakByEnergy) {
  const Puncture needle =
      of(kSoft, "puncture = { toughness_j_per_m2 = 1000.0, membrane_j = 0.002 }")[0];
  EXPECT_EQ(needle.rule, "force");
  ASSERT_EQ(needle.membrane_j.size(), 2U);
  EXPECT_TRUE(std::isnan(needle.membrane_j[0]));
  EXPECT_EQ(needle.membrane_j[1], 0.002);
  EXPECT_EQ(needle.membrane_n[1], 1.5);  // for readers that know no energy
  EXPECT_TRUE(of(kSoft, kFirm)[0].membrane_j.empty());
}

// The ball is 60 mm through at the top; of what a needle may not enter, 1 mm.
TEST_F(NeedleLayersTest, TheShaftGoesAsFarAsTheBodyHasRoom) {
  const Puncture through = of(kSoft, kFirm, "tip_angle_deg = 30.0")[0];
  EXPECT_NEAR(through.insertable_m, 0.06, 6e-4);
  EXPECT_EQ(through.radius_m, 0.0005);
  EXPECT_NEAR(through.tip_angle_rad, std::numbers::pi / 6.0, 1e-15);
  Scene top = scene(kSoft, "", "");
  top.reach.box_m = Eigen::AlignedBox3d(Eigen::Vector3d(-1.0, -1.0, 0.0299),
                                        Eigen::Vector3d(1.0, 1.0, 1.0));
  const Puncture stopped = needle_layers(top, read_body(top))[0];
  EXPECT_NEAR(stopped.insertable_m, 0.001, 2e-4);
  EXPECT_EQ(stopped.tip_angle_rad, 0.0);
}

TEST_F(NeedleLayersTest, TheBallThatIsPressedStandsForTheNeedle) {
  EXPECT_EQ(scene(kSoft, kFirm, "press_radius_m = 0.002").tool[0].radius_m, 0.002);
  EXPECT_EQ(scene(kSoft, kFirm, "").tool[0].radius_m, 0.0005);
  EXPECT_EQ(scene(kSoft, kFirm, "").tool[0].kind, "sphere");
}

TEST_F(NeedleLayersTest, WrongKeysAreSaid) {
  const auto said = [&](const std::string& body, const std::string& tool = "") {
    try {
      (void)scene(body, kFirm, tool);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(said("puncture = { toughness_j_per_m2 = 1.0, friction = 0.2 }")
                .find("radial_stress_pa"),
            std::string::npos);
  EXPECT_NE(said("puncture = { toughness_j_per_m2 = 1.0, membrane_n = 1.0, "
                 "membrane_j = 1.0 }")
                .find("must have one"),
            std::string::npos);
  EXPECT_NE(said("puncture = { toughness_j_per_m2 = -1.0 }").find("toughness"),
            std::string::npos);
  EXPECT_NE(said("puncture = { friction_n_per_m = 1.0 }").find("toughness_j_per_m2"),
            std::string::npos);
  EXPECT_NE(said(kSoft, "tip_radius_m = 0.1").find("tip_radius_m"), std::string::npos);
  EXPECT_NE(said(kSoft, "tip_angle_deg = 120.0").find("at most 110"),
            std::string::npos);
  EXPECT_NE(said(kSoft, "puncture = { mouth_m = 0.0 }").find("mouth_m"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate
