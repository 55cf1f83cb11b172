#include "precompute/press/node_yielding.h"

#include <cmath>
#include <fstream>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/obj_writer.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// A ball with a harder one inside, right under its top.
class NodeYieldingTest : public testing::Test {
 protected:
  std::vector<Yielding> of(const std::string& body, const std::string& lump,
                           const std::string& tool) {
    write_obj(icosphere(0.03, 3), folder_ / "body.obj", "a body");
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
name = "tip"
shape = "sphere"
radius_m = 0.01
)" << tool << R"(
[reach]
depth_max_m = 0.004
)";
    const Scene scene = read_scene(folder_ / "scene.toml");
    body_ = read_body(scene);
    return node_yielding(scene, body_);
  }

  ScratchFolder folder_;
  BodySource body_;
};

#define PALPATE_PLASTIC "plastic = { yield_depth_m = 0.001, share = 0.4 }\n"
#define PALPATE_DAMAGE "damage = { onset_m = 0.002, scale_m = 0.003, largest = 0.3 }\n"
constexpr const char* kPlastic = PALPATE_PLASTIC;
constexpr const char* kDamage = PALPATE_DAMAGE;
constexpr const char* kBoth = PALPATE_PLASTIC PALPATE_DAMAGE;

TEST_F(NodeYieldingTest, IsOneRowWhereMaterialsAgreeAndNoneWhereNothingYields) {
  EXPECT_TRUE(of("", "", "").empty());
  const std::vector<Yielding> both = of(kBoth, kBoth, "");
  ASSERT_EQ(both.size(), 1U);
  EXPECT_EQ(both[0].share, (std::vector<double>{0.4}));
  EXPECT_EQ(both[0].yield_depth_m, (std::vector<double>{0.001}));
  EXPECT_EQ(both[0].largest, (std::vector<double>{0.3}));
  EXPECT_EQ(both[0].onset_m, (std::vector<double>{0.002}));
  EXPECT_EQ(both[0].scale_m, (std::vector<double>{0.003}));
}

TEST_F(NodeYieldingTest, ANodeTakesTheMaterialUnderIt) {
  const Yielding yielding = of(kPlastic, "", "")[0];
  ASSERT_EQ(std::ssize(yielding.share), body_.normal.rows());
  EXPECT_TRUE(yielding.largest.empty());
  // Half a contact radius, sqrt(10 mm x 2 mm) / 2 = 2.2 mm, under the top lies the
  // lump.
  int over = 0;
  for (Eigen::Index v = 0; v < body_.normal.rows(); ++v) {
    const Eigen::Vector3d under =
        0.03 * body_.normal.row(v).transpose() * (1.0 - 0.00224 / 0.03);
    const double distance_m = (under - Eigen::Vector3d(0.0, 0.0, 0.02)).norm();
    if (std::abs(distance_m - 0.009) < 5e-4) {
      continue;  // on the lump's faceted surface
    }
    const bool inside = distance_m < 0.009;
    over += inside ? 1 : 0;
    EXPECT_EQ(yielding.share[static_cast<std::size_t>(v)], inside ? 0.0 : 0.4) << v;
    // One that does not yield would at the largest depth.
    EXPECT_EQ(yielding.yield_depth_m[static_cast<std::size_t>(v)],
              inside ? 0.004 : 0.001);
  }
  EXPECT_GE(over, 3);
}

TEST_F(NodeYieldingTest, AToolsOwnComesBeforeTheMaterials) {
  const Yielding yielding =
      of(kBoth, kDamage, "plastic = { yield_depth_m = 0.002, share = 0.1 }\n")[0];
  EXPECT_EQ(yielding.share, (std::vector<double>{0.1}));
  EXPECT_EQ(yielding.yield_depth_m, (std::vector<double>{0.002}));
  EXPECT_EQ(yielding.largest, (std::vector<double>{0.3}));
}

TEST_F(NodeYieldingTest, WhatNoPressReachesIsRefused) {
  for (const auto& [body, tool, says] :
       {std::tuple{"plastic = { yield_depth_m = 0.004, share = 0.4 }\n", "",
                   "[[material]] of region \"body\": plastic.yield_depth_m is 0.004 m, "
                   "must be less than depth_max_m of [reach], 0.004 m"},
        std::tuple{"", "damage = { onset_m = 0.01, scale_m = 1, largest = 0.4 }\n",
                   "[[tool]] \"tip\": damage.onset_m is 0.01 m"}}) {
    try {
      (void)of(body, "", tool);
      FAIL() << says;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos)
          << error.what();
    }
  }
}

TEST(YieldingScene, TheDemosOrganKeepsDentsAndSoftens) {
  const Scene scene = read_scene("data/yielding.toml");
  const std::vector<Yielding> yielding = node_yielding(scene, read_body(scene));
  ASSERT_EQ(yielding.size(), 1U);
  EXPECT_EQ(yielding[0].share, (std::vector<double>{0.4}));
  EXPECT_EQ(yielding[0].largest, (std::vector<double>{0.3}));
}

// Whatever their order.
TEST(RegionOf, APointIsInTheThinnestLayerThatIsDeepEnough) {
  BodySource body;
  body.surface = icosphere(0.03, 3);
  body.inner = {{.name = "fat", .cut = true, .under_m = 0.01},
                {.name = "skin", .cut = true, .under_m = 0.003}};
  EXPECT_EQ(region_of(body, {0.0, 0.0, 0.028}), 2);
  EXPECT_EQ(region_of(body, {0.0, 0.0, 0.023}), 1);
  EXPECT_EQ(region_of(body, {0.0, 0.0, 0.015}), 0);
}

}  // namespace
}  // namespace palpate
