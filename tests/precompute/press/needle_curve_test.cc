// A needle's curve of a larger ball's, against presses of the small ball.
#include "precompute/press/needle_curve.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/mesh/obj_writer.h"
#include "precompute/contact/indentation_response.h"
#include "precompute/press/work_unit_solver.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr TipTissue kTissue{.youngs_modulus_pa = 15000.0, .poissons_ratio = 0.45};

TEST(Sharpen, AConeDeepensABallOfItsOwnRadius) {
  NodeResponse ball;
  for (int k = 0; k <= 10; ++k) {
    ball.depth_m.push_back(3e-4 * k);
    ball.force_n.push_back(5e-4 * k * k);
  }
  NodeResponse needle = ball;
  const NeedleTip tip{.radius_m = 0.001, .half_angle_rad = 0.26};
  sharpen(kTissue, tip, 0.001, false, needle);
  for (std::size_t k = 1; k < ball.depth_m.size(); ++k) {
    EXPECT_NEAR(needle.depth_m[k] - ball.depth_m[k],
                linear_cone_depth_m(kTissue, tip, ball.force_n[k]) -
                    linear_tip_depth_m(kTissue, 0.001, ball.force_n[k]),
                1e-12);
  }
  EXPECT_GT(needle.error_relative, 0.0);
}

TEST(Sharpen, NonlinearPressesDeepenByTheNonlinearHalfSpace) {
  NodeResponse ball;
  for (int k = 0; k <= 10; ++k) {
    ball.depth_m.push_back(3e-4 * k);
    ball.force_n.push_back(1e-3 * k * k);
  }
  const auto more_m = [&](std::size_t k) {
    return nonlinear_tip_depth_m(kTissue, 0.001, ball.force_n[k]) -
           nonlinear_tip_depth_m(kTissue, 0.003, ball.force_n[k]);
  };
  for (const double half_angle : {0.0, 0.26}) {
    NodeResponse needle = ball;
    const NeedleTip tip{.radius_m = 0.001, .half_angle_rad = half_angle};
    sharpen(kTissue, tip, 0.003, true, needle);
    for (std::size_t k = 1; k < ball.depth_m.size(); ++k) {
      const double force_n = ball.force_n[k];
      const double pointed_m = half_angle > 0.0
                                   ? linear_cone_depth_m(kTissue, tip, force_n) -
                                         linear_tip_depth_m(kTissue, 0.001, force_n)
                                   : 0.0;
      EXPECT_NEAR(needle.depth_m[k] - ball.depth_m[k], more_m(k) + pointed_m, 1e-12);
    }
    // Deeper than by the linear half-space.
    NodeResponse linear = ball;
    sharpen(kTissue, tip, 0.003, false, linear);
    EXPECT_GT(needle.depth_m.back(), 1.05 * linear.depth_m.back());
  }
}

TEST(Sharpen, ForcesStayAndDepthsGrow) {
  NodeResponse ball;
  for (int k = 0; k <= 10; ++k) {
    ball.depth_m.push_back(3e-4 * k);
    ball.force_n.push_back(0.01 * k * k - (k == 10 ? 0.3 : 0.0));
  }
  ball.tilt = TiltLine{.tilt = {0.1, 0.0, 0.0}, .by_depth_per_m = {20.0, 0.0, 0.0}};
  ball.error_relative = 0.03;
  NodeResponse needle = ball;
  sharpen(kTissue, {.radius_m = 0.0005}, 0.003, false, needle);
  EXPECT_EQ(needle.force_n, ball.force_n);
  EXPECT_EQ(needle.depth_m[0], 0.0);
  for (std::size_t k = 1; k < ball.depth_m.size(); ++k) {
    EXPECT_GT(needle.depth_m[k], needle.depth_m[k - 1]);
    EXPECT_GT(needle.depth_m[k], ball.depth_m[k]);
  }
  EXPECT_NEAR(needle.tilt->at(needle.depth_m.back())[0],
              ball.tilt->at(ball.depth_m.back())[0], 1e-12);
  EXPECT_EQ(needle.tilt->tilt, ball.tilt->tilt);
  const double part = 1.0 - ball.depth_m[9] / needle.depth_m[9];
  EXPECT_GE(needle.error_relative, std::hypot(0.03, kSharpenError * part) - 1e-12);
  EXPECT_LT(needle.error_relative, kSharpenError);
  // A needle as large as its ball is its ball.
  NodeResponse same = ball;
  sharpen(kTissue, {.radius_m = 0.003}, 0.003, true, same);
  EXPECT_EQ(same.depth_m, ball.depth_m);
  EXPECT_EQ(same.error_relative, ball.error_relative);
}

TEST(NeedleNotes, AreOfNeedlesThatGoDeeperThanWasCompared) {
  Scene scene;
  scene.tool.resize(3);
  scene.tool_needle.resize(3);
  scene.reach.depth_max_m = 0.005;
  scene.tool_needle[1] = SceneNeedle{.radius_m = 0.001, .press_radius_m = 0.002};
  scene.tool_needle[2] = SceneNeedle{.radius_m = 0.001, .press_radius_m = 0.001};
  EXPECT_EQ(needle_notes(scene).size(), 1U);
  scene.tool_needle[2]->tip_angle_rad = 0.5;
  EXPECT_EQ(needle_notes(scene).size(), 2U);
  EXPECT_EQ(needle_notes(scene)[0].find("extrapolated"), std::string::npos);
  scene.reach.depth_max_m = 0.006;
  EXPECT_NE(needle_notes(scene)[0].find("extrapolated"), std::string::npos);
  scene.reach.depth_max_m = 0.0039;
  EXPECT_TRUE(needle_notes(scene).empty());
}

class PressedNeedle : public testing::Test {
 protected:
  // A block of a soft tissue; the skin's modulus times that of what is below.
  void read(const std::string& tools, double skin_times) {
    write_obj(icosphere(0.03, 3), folder_ / "body.obj", "a body");
    std::ofstream(folder_ / "scene.toml") << fmt::format(R"([body]
mesh = "body.obj"
length_unit = "m"
[[layer]]
name = "skin"
thickness_m = 0.003
[[material]]
region = "body"
law = "linear"
youngs_modulus_pa = 15000.0
poissons_ratio = 0.45
[[material]]
region = "skin"
law = "linear"
youngs_modulus_pa = {}
poissons_ratio = 0.45
puncture = {{ toughness_j_per_m2 = 300.0 }}
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, -0.02]]
{}
[reach]
box_m = [[-0.004, -0.004, 0.0], [0.004, 0.004, 1.0]]
depth_max_m = 0.003
[accuracy]
depths = 8
verify = 2
method = "linear"
)",
                                                         15000.0 * skin_times, tools);
    scene_ = read_scene(folder_ / "scene.toml");
    body_ = read_body(scene_);
  }

  // Of the node on top, by tool: as units of work answer.
  std::vector<NodeResponse> pressed() {
    const std::vector<std::int32_t> reachable = reachable_vertices(scene_, body_);
    Eigen::Index top = 0;
    body_.surface.position_m.col(2).maxCoeff(&top);
    const PressStrategy strategy = choose_strategy(scene_, body_, reachable);
    Progress quiet(nullptr);
    const SceneSolver solver(scene_, body_, strategy, reachable, reachable, quiet);
    const WorkUnit unit{
        .index = 0, .is_check = true, .vertex = {static_cast<std::int32_t>(top)}};
    std::vector<NodeResponse> responses;
    for (const WorkUnitNode& node :
         solve_unit(scene_, body_, strategy, solver, unit, false).node) {
      responses.push_back(node.response);
    }
    return responses;
  }

  ScratchFolder folder_;
  Scene scene_;
  BodySource body_;
};

double force_at(const NodeResponse& response, double depth_m) {
  const auto next =
      std::upper_bound(response.depth_m.begin(), response.depth_m.end(), depth_m) -
      response.depth_m.begin();
  const auto k = static_cast<std::size_t>(
      std::min<std::ptrdiff_t>(next, std::ssize(response.depth_m) - 1));
  const double u = (depth_m - response.depth_m[k - 1]) /
                   (response.depth_m[k] - response.depth_m[k - 1]);
  return (1.0 - u) * response.force_n[k - 1] + u * response.force_n[k];
}

// A needle of 1 mm, by a ball of 3 mm and by itself. Left as it is, the ball pushes
// back with 1.3 to 2.2 times the force.
TEST_F(PressedNeedle, OfALargerBallIsAsOfItsOwnTip) {
  for (const double skin_times : {1.0, 4.0}) {
    read(R"([[tool]]
name = "needle"
shape = "needle"
radius_m = 0.001
edge_width_m = 0.001
press_radius_m = 0.003
[[tool]]
name = "tip"
shape = "sphere"
radius_m = 0.001
)",
         skin_times);
    const std::vector<NodeResponse> response = pressed();
    ASSERT_EQ(response.size(), 2U);
    const NodeResponse& needle = response[0];
    ASSERT_GT(needle.depth_m.size(), 5U);
    EXPECT_GT(needle.depth_m.back(), 1.25 * 0.003);
    EXPECT_GT(needle.error_relative, response[1].error_relative);
    for (const double depth_m : {0.001, 0.002, 0.0028}) {
      const double wanted_n = force_at(response[1], depth_m);
      const double found_n = force_at(needle, depth_m);
      EXPECT_NEAR(found_n / wanted_n, 1.0, needle.error_relative)
          << skin_times << " " << depth_m;
      EXPECT_NEAR(found_n / wanted_n, 1.0, 0.06) << skin_times << " " << depth_m;
    }
  }
}

}  // namespace
}  // namespace palpate
