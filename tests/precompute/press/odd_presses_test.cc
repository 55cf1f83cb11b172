// Presses that are not a ball on a flat place: a cup, a fin, a fold, a sharp corner,
// two lobes. What their curves are, and that nothing in them is not a number.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/mesh/obj_writer.h"
#include "precompute/contact/indentation_response.h"
#include "precompute/press/node_press.h"
#include "precompute/press/nonlinear_press.h"
#include "precompute/press/own_mesh_press.h"
#include "precompute/press/response_ratio.h"
#include "precompute/press/scene_solver.h"
#include "tests/support/odd_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr double kHalf = 0.02;
constexpr int kCells = 16;  // 2.5 mm

class OddPresses : public testing::Test {
 protected:
  // Presses vertices of a body that is held at its floor, each on a mesh of its own.
  std::vector<PressedNode> press(const SurfaceMesh& body,
                                 const std::vector<std::int32_t>& vertices,
                                 const std::string& law, double radius_m = 0.006,
                                 double depth_m = 0.003, int depths = 4) {
    write_obj(body, folder_ / "body.obj", "an odd body");
    std::ofstream(folder_ / "scene.toml") << fmt::format(
        R"([body]
mesh = "body.obj"
length_unit = "m"
[[material]]
region = "body"
law = "{}"
youngs_modulus_pa = 5000.0
poissons_ratio = 0.45
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, -0.0099]]
[[tool]]
name = "ball"
shape = "sphere"
radius_m = {}
[reach]
depth_max_m = {}
[accuracy]
force_relative = 0.2
depths = {}
verify = 0
)",
        law, radius_m, depth_m, depths);
    scene_ = read_scene(folder_ / "scene.toml");
    body_ = read_body(scene_);
    std::vector<PressedNode> nodes;
    for (const std::int32_t v : vertices) {
      nodes.push_back(
          press_on_own_mesh(scene_, body_, body_.tool.front(), {&v, 1},
                            contact_focus(scene_, body_),
                            {.nonlinear = law != "linear",
                             .options = nonlinear_options(scene_, body_.tool.front())})
              .front());
    }
    return nodes;
  }

  static std::int32_t middle() { return top_vertex(kHalf, kCells, 0.0, 0.0); }

  static NodeResponse response(const PressedNode& node) {
    NodeResponse made = to_response(node.indentation, node.path, 0.2);
    EXPECT_EQ(broken_rule(node.indentation), "");
    return made;
  }

  ScratchFolder folder_;
  Scene scene_;
  BodySource body_;
};

// Gaps are averaged over the hats of contact nodes, which reach to the next nodes: the
// touch is told late, never early, and by less than their distance.
void expect_touch(const PressedNode& node, double exact_m) {
  const double late_m = node.indentation.sample.front().penetration_m - exact_m;
  EXPECT_GE(late_m, 0.0);
  EXPECT_LT(late_m, node.indentation.node_spacing_m);
}

void expect_rising(const NodeResponse& response) {
  for (std::size_t k = 1; k < response.force_n.size(); ++k) {
    EXPECT_GT(response.force_n[k], response.force_n[k - 1]) << k;
  }
}

double flat(double, double) {
  return 0.0;
}

// A cup whose floor curves more than the ball: the ball rests on the rim's inner side.
double cup(double x, double y) {
  const double r2 = (x * x + y * y) / (0.008 * 0.008);
  return r2 < 1.0 ? -0.006 * (1.0 - r2) : 0.0;
}

TEST_F(OddPresses, InACupTheBallTouchesEarlyAndTheCurveBeginsThere) {
  const SurfaceMesh body = relief(kHalf, -0.01, kCells, cup);
  for (const char* law : {"linear", "neo-hookean"}) {
    const PressedNode node = press(body, {middle()}, law, 0.009).front();
    EXPECT_EQ(node.failure, "") << law;
    const NodeResponse r = response(node);
    ASSERT_EQ(r.origin, ResponseOrigin::kSimulated) << law;
    // The ball of 9 mm stands on the circle where the cup is as steep as it is.
    EXPECT_LT(r.touch_offset_m, -0.0002) << law;
    EXPECT_EQ(r.depth_m.front(), 0.0);
    EXPECT_EQ(r.force_n.front(), 0.0);
    expect_rising(r);
  }
}

TEST_F(OddPresses, ThePathOfANonlinearPressBeginsAtItsTouchAlsoWhereThatIsNegative) {
  // A soft and a linear body agree where strains are small, wherever the touch is: the
  // shallow samples of the cup must not depend on where zero lies.
  const SurfaceMesh body = relief(kHalf, -0.01, kCells, cup);
  const PressedNode soft =
      press(body, {middle()}, "neo-hookean", 0.009, 0.001, 8).front();
  ASSERT_TRUE(is_predictor(soft.indentation));
  ASSERT_TRUE(is_predictor(soft.linear));
  const auto ratio = path_ratio(soft.indentation, soft.linear);
  ASSERT_TRUE(ratio);
  for (Eigen::Index k = 0; k < 2; ++k) {  // up to a sixteenth of the depth
    EXPECT_NEAR(ratio->force[k], 1.0, 0.1) << k;
  }
}

// A thin plate that stands on the block: one row of vertices, 5 mm wide at its foot.
double fin(double x, double y) {
  return std::abs(x) < 0.0013 && std::abs(y) < 0.016 ? 0.008 : 0.0;
}

// A slit 5 mm wide at its floor and 10 mm at its mouth, 6 mm deep.
double trench(double x, double y) {
  return std::abs(x) < 0.003 && std::abs(y) < 0.016 ? -0.006 : 0.0;
}

// Two hills, with a valley between them that is narrower than the ball.
double lobes(double x, double) {
  const double s = std::sin(std::numbers::pi * x / kHalf);
  return 0.008 * s * s - 0.004;
}

// A plateau beside the middle, 12 mm high.
double plateau(double x, double y) {
  return x > 0.004 && x < 0.016 && std::abs(y) < 0.016 ? 0.012 : 0.0;
}

TEST_F(OddPresses, AFinIsPressedAllTheWay) {
  const PressedNode node =
      press(relief(kHalf, -0.01, kCells, fin), {middle()}, "neo-hookean", 0.004, 0.004)
          .front();
  EXPECT_EQ(node.failure, "");
  ASSERT_EQ(node.indentation.sample.size(), 5U);
  EXPECT_FALSE(node.indentation.reaches_elsewhere);
  const NodeResponse r = response(node);
  expect_touch(node, 0.0);
  expect_rising(r);
}

TEST_F(OddPresses, AnEarFoldsAwayAndItsCurveIsWhatThatLeaves) {
  const SurfaceMesh ear = leaning(relief(kHalf, -0.01, kCells, fin), 0.8);
  const PressedNode node = press(ear, {middle()}, "neo-hookean", 0.004, 0.004).front();
  EXPECT_EQ(node.failure, "");
  ASSERT_EQ(node.indentation.sample.size(), 5U);
  ASSERT_EQ(node.linear.sample.size(), 5U);
  EXPECT_EQ(response(node).origin, ResponseOrigin::kSimulated);
  // Bent by half of its height it carries a tenth of what a linear plate would: its
  // ratio would say nothing about others.
  const double share = node.indentation.sample.back().force_n.norm() /
                       node.linear.sample.back().force_n.norm();
  EXPECT_GT(share, 0.05);
  EXPECT_LT(share, 0.25);
}

TEST_F(OddPresses, InATrenchTheBallStandsOnItsEdges) {
  const PressedNode node =
      press(relief(kHalf, -0.01, kCells, trench), {middle()}, "linear", 0.009).front();
  ASSERT_EQ(node.failure, "");
  // A ball of 9 mm on two edges 10 mm apart, 6 mm above the floor.
  const double above_m = std::sqrt(0.009 * 0.009 - 0.005 * 0.005) + 0.006;
  const NodeResponse r = response(node);
  expect_touch(node, 0.009 - above_m);
  EXPECT_FALSE(node.indentation.reaches_elsewhere);  // its walls are in the patch
  expect_rising(r);
}

TEST_F(OddPresses, TwoLobesAreTouchedOnTheirFlanks) {
  // Between vertices 2.5 mm apart the surface is straight.
  double highest_m = 0.0;
  for (double x = 0.0; x < 0.006; x += 1e-5) {
    const double left = 0.0025 * std::floor(x / 0.0025);
    const double t = (x - left) / 0.0025;
    const double z = (1.0 - t) * lobes(left, 0.0) + t * lobes(left + 0.0025, 0.0);
    highest_m = std::max(highest_m, z - lobes(0.0, 0.0) + std::sqrt(36e-6 - x * x));
  }
  for (const char* law : {"linear", "neo-hookean"}) {
    const PressedNode node =
        press(relief(kHalf, -0.01, kCells, lobes), {middle()}, law, 0.006).front();
    ASSERT_EQ(node.failure, "") << law;
    const NodeResponse r = response(node);
    expect_touch(node, 0.006 - highest_m);
    EXPECT_FALSE(node.indentation.reaches_elsewhere) << law;
    expect_rising(r);
  }
}

TEST_F(OddPresses, TheOppositeWallOfAFoldIsFlagged) {
  // The trench leans: one wall hangs over its floor, where the ball must pass.
  const SurfaceMesh fold = leaning(relief(kHalf, -0.01, kCells, trench), 0.0, 0.8);
  for (const char* law : {"linear", "neo-hookean"}) {
    const PressedNode node = press(fold, {middle()}, law, 0.006).front();
    ASSERT_EQ(node.failure, "") << law;
    EXPECT_TRUE(node.indentation.reaches_elsewhere) << law;
    EXPECT_NE(response(node).flags & kErrorOverBudget, 0) << law;
  }
}

TEST_F(OddPresses, ALobeThatHangsOverTheVertexIsFlagged) {
  const SurfaceMesh body = leaning(relief(kHalf, -0.01, kCells, plateau), -0.5);
  const PressedNode node = press(body, {middle()}, "linear", 0.006).front();
  ASSERT_EQ(node.failure, "");
  EXPECT_TRUE(node.indentation.reaches_elsewhere);
  EXPECT_NE(response(node).flags & kErrorOverBudget, 0);
}

TEST_F(OddPresses, OnAFlatPlaceNothingElseIsReached) {
  const PressedNode node =
      press(relief(kHalf, -0.01, kCells, flat), {middle()}, "linear").front();
  ASSERT_EQ(node.failure, "");
  EXPECT_FALSE(node.indentation.reaches_elsewhere);
  EXPECT_EQ(response(node).flags & kErrorOverBudget, 0);
}

TEST_F(OddPresses, ASharpCornerIsTouchedAtOnce) {
  const SurfaceMesh body = relief(kHalf, -0.01, 1, flat);  // a box of eight vertices
  const PressedNode node = press(body, {0}, "linear").front();
  ASSERT_EQ(node.failure, "");
  EXPECT_FALSE(touches_late(node));
  EXPECT_EQ(response(node).origin, ResponseOrigin::kSimulated);
}

TEST(Guides, PressesWithoutForceAtSomeDepthAreNone) {
  Indentation path;
  for (int k = 0; k <= 4; ++k) {
    path.sample.push_back(
        {.penetration_m = 1e-3 * k, .force_n = Eigen::Vector3d(0.0, 0.0, 0.1 * k)});
  }
  EXPECT_TRUE(is_predictor(path));
  Indentation lost = path;  // contact lost on the way
  lost.sample[3].force_n.setZero();
  EXPECT_FALSE(is_predictor(lost));
  EXPECT_FALSE(path_ratio(lost, path));
  EXPECT_FALSE(path_ratio(path, lost));
  Indentation broken = path;
  broken.sample[2].force_n[0] = std::nan("");
  EXPECT_FALSE(is_predictor(broken));
  EXPECT_NE(broken_rule(broken), "");
  Indentation other = path;  // another mechanism at one depth
  other.sample[4].force_n *= 20.0;
  EXPECT_TRUE(is_predictor(other));
  EXPECT_FALSE(path_ratio(other, path));
}

TEST(Guides, ACurveThatLosesContactIsStoredAsItWasPressed) {
  Indentation path;
  const double force[] = {0.0, 0.1, 0.2, 0.0, 0.0, 0.3};
  for (int k = 0; k < 6; ++k) {
    path.sample.push_back({.penetration_m = 1e-3 * k,
                           .force_n = Eigen::Vector3d(0.0, 0.0, force[k]),
                           .coarse_force_n = force[k]});
  }
  const IndentationPath along{.vertex_m = Eigen::Vector3d::Zero(),
                              .outward = Eigen::Vector3d::UnitZ(),
                              .tool = {},
                              .depth_max_m = 5e-3};
  const NodeResponse r = to_response(path, along, 0.05);
  ASSERT_EQ(r.force_n.size(), 6U);
  for (int k = 0; k < 6; ++k) {
    EXPECT_DOUBLE_EQ(r.force_n[static_cast<std::size_t>(k)], force[k]);
  }
  EXPECT_DOUBLE_EQ(r.error_relative, 0.2 * 0.05);  // the least there is, not 0/0
  Indentation nothing = path;
  for (IndentationSample& sample : nothing.sample) {
    sample.force_n.setZero();
  }
  EXPECT_EQ(to_response(nothing, along, 0.05).origin, ResponseOrigin::kNone);
}

}  // namespace
}  // namespace palpate
