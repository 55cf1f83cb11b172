#include "precompute/press/press_cost.h"

#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/mesh/obj_writer.h"
#include "precompute/body/meshed_body.h"
#include "precompute/press/scene_solver.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// A ball of 12 cm of which the tool reaches what lies above some height.
class PressCost : public testing::Test {
 protected:
  void read(double above_m, double radius_m = 0.006, double depth_m = 0.004) {
    write_obj(icosphere(0.06, 3), folder_ / "ball.obj", "a ball");
    std::ofstream(folder_ / "scene.toml") << fmt::format(R"([body]
mesh = "ball.obj"
length_unit = "m"
[[material]]
region = "body"
law = "linear"
youngs_modulus_pa = 5000.0
poissons_ratio = 0.48
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, -0.04]]
[[tool]]
name = "ball"
shape = "sphere"
radius_m = {}
[reach]
box_m = [[-1.0, -1.0, {}], [1.0, 1.0, 1.0]]
depth_max_m = {}
)",
                                                         radius_m, above_m, depth_m);
    scene_ = read_scene(folder_ / "scene.toml");
    body_ = read_body(scene_);
    vertices_ = reachable_vertices(scene_, body_);
  }

  ScratchFolder folder_;
  Scene scene_;
  BodySource body_;
  std::vector<std::int32_t> vertices_;
};

TEST(ExpectedCost, IsAFactorAndItsColumns) {
  const double factor_s = expected_cpu_s({4000.0, 0.0});
  EXPECT_DOUBLE_EQ(expected_cpu_s({4000.0, 300.0}),
                   factor_s + 300.0 * expected_column_cpu_s(4000.0));
  EXPECT_DOUBLE_EQ(expected_cpu_s({8000.0, 0.0}), std::pow(2.0, 1.48) * factor_s);
  EXPECT_DOUBLE_EQ(expected_column_cpu_s(8000.0),
                   std::pow(2.0, 1.24) * expected_column_cpu_s(4000.0));
}

TEST_F(PressCost, AMeshOfItsOwnIsCountedAsItIsMade) {
  read(0.055);
  const std::vector<std::int32_t> one{vertices_[vertices_.size() / 2]};
  const ContactFocus focus = contact_focus(scene_, body_);
  const MeshWork counted = own_mesh_work(scene_, body_, one, focus);
  const BodyModel model = make_graded_model(scene_, body_, one, focus);
  const double nodes = static_cast<double>(model.contact.node.size());
  EXPECT_NEAR(2.0 * counted.triangles + 2.0, nodes, 0.05 * nodes);  // V + E = 2 F + 2
  const PressedNode placed =
      placed_node(scene_, body_, model, body_.tool.front(), one.front());
  const double columns = static_cast<double>(placed.patch.size());
  EXPECT_NEAR(counted.columns, columns, 0.2 * columns);
}

TEST_F(PressCost, FewVerticesGetMeshesOfTheirOwnAndManyShareOne) {
  read(0.058);
  EXPECT_LT(vertices_.size(), 30U);
  EXPECT_FALSE(choose_strategy(scene_, body_, vertices_).shared_mesh);
  // The contact of a large tool, for which the whole surface is fine enough or nearly
  // so.
  read(-0.03, 0.05, 0.02);
  EXPECT_GT(vertices_.size(), 400U);
  EXPECT_TRUE(choose_strategy(scene_, body_, vertices_).shared_mesh);
}

}  // namespace
}  // namespace palpate
