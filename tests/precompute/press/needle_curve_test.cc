// A needle's curve of a larger ball's: closed forms, and presses of the small ball.
#include "precompute/press/needle_curve.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
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
constexpr double kPlanePa = 15000.0 / (1.0 - 0.45 * 0.45);
constexpr double kRadiusM = 0.001;

// F at a depth, by bisection of the depth at a force.
template <typename Depth>
double bisected_force_n(double depth_m, const Depth& depth_m_at) {
  double low = 0.0;
  double high = 100.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (depth_m_at(middle) < depth_m ? low : high) = middle;
  }
  return low;
}

double linear_force_n(double depth_m) {
  return bisected_force_n(depth_m, [](double f) {
    return linear_tip_depth_m(kTissue, kRadiusM, f);
  });
}

// F / (E R^2) at h / R.
double deep_force(double poissons_ratio, double radii) {
  const TipTissue tissue{.youngs_modulus_pa = 2000.0, .poissons_ratio = poissons_ratio};
  return bisected_force_n(0.002 * radii,
                          [&](double f) {
                            return nonlinear_tip_depth_m(tissue, 0.002, f);
                          }) /
         (2000.0 * 0.002 * 0.002);
}

double deep_slope(double radii) {
  return (deep_force(0.5, radii + 1e-4) - deep_force(0.5, radii - 1e-4)) / 2e-4;
}

TEST(LinearTip, IsAnExactSphere) {
  // Sneddon 1965: d/R and F over that of Hertz.
  for (const auto& [x, part] : {std::pair{0.05, 0.9950},
                                {0.10, 0.9900},
                                {0.30, 0.9699},
                                {0.50, 0.9498},
                                {1.00, 0.8998}}) {
    const double depth_m = x * kRadiusM;
    const double hertz_n =
        4.0 / 3.0 * kPlanePa * std::sqrt(kRadiusM) * std::pow(depth_m, 1.5);
    EXPECT_NEAR(linear_force_n(depth_m) / hertz_n, part, 1e-4) << x;
  }
  EXPECT_EQ(linear_tip_depth_m(kTissue, kRadiusM, 0.0), 0.0);
}

TEST(LinearTip, IsAFlatPunchDeepDown) {
  const double h_m = 1e-4;
  for (const double x : {10.0, 20.0, 400.0}) {
    const double slope =
        (linear_force_n(x * kRadiusM + h_m) - linear_force_n(x * kRadiusM - h_m)) /
        (2.0 * h_m);
    EXPECT_NEAR(slope / (2.0 * kPlanePa * kRadiusM), 1.0, 1e-6) << x;
  }
}

// tests/bench/deep_tip prints these, each within 1 % of its own.
TEST(DeepTip, IsWhatAFiniteElementSolutionFinds) {
  for (const auto& [x, force] : {std::pair{0.05, 0.0196},
                                 {0.1, 0.0546},
                                 {0.2, 0.1518},
                                 {0.3, 0.2737},
                                 {0.5, 0.5694},
                                 {0.7, 0.9107},
                                 {1.0, 1.4679},
                                 {1.5, 2.4246},
                                 {2.0, 3.2683},
                                 {2.5, 3.9833},
                                 {3.0, 4.7006},
                                 {3.5, 5.4725},
                                 {4.0, 6.2918}}) {
    EXPECT_NEAR(deep_force(0.5, x) / force, 1.0, 0.01) << x;
  }
}

// The same with --nu: 0.45 and 0.3.
TEST(DeepTip, TurnsIntoOtherPoissonsRatios) {
  for (const auto& [x, force] : {std::pair{0.05, 0.0186},
                                 {0.5, 0.5489},
                                 {1.0, 1.4320},
                                 {1.5, 2.3940},
                                 {2.0, 3.2684},
                                 {2.5, 4.0116},
                                 {3.0, 4.7558}}) {
    EXPECT_NEAR(deep_force(0.45, x) / force, 1.0, 0.015) << x;
  }
  for (const auto& [x, force] :
       {std::pair{0.05, 0.0167}, {0.3, 0.2438}, {0.7, 0.8424}}) {
    EXPECT_NEAR(deep_force(0.3, x) / force, 1.0, 0.04) << x;
  }
}

TEST(DeepTip, BeginsAsHertzAndEndsAsAThimble) {
  for (const double nu : {0.3, 0.45, 0.5}) {
    const double hertz = 4.0 / 3.0 / (1.0 - nu * nu);
    EXPECT_NEAR(deep_force(nu, 1e-3) / (hertz * std::pow(1e-3, 1.5)), 1.0, 0.01) << nu;
    EXPECT_NEAR(deep_force(nu, 0.05) / (hertz * std::pow(0.05, 1.5)), 1.0, 0.03) << nu;
    EXPECT_NEAR(deep_force(nu, 0.1) / (hertz * std::pow(0.1, 1.5)), 1.0, 0.03) << nu;
  }
  const double thimble = 2.0 * std::numbers::pi / 3.0;
  EXPECT_NEAR(deep_slope(20.0) / thimble, 1.0, 0.03);
  EXPECT_NEAR(deep_slope(1000.0) / thimble, 1.0, 1e-3);
  EXPECT_EQ(nonlinear_tip_depth_m(kTissue, kRadiusM, 0.0), 0.0);
}

// The slope falls around 2 radii, where the tip begins to draw the tissue along.
TEST(DeepTip, RisesEverywhereAndItsSlopeHasNoJump) {
  double before = deep_slope(0.02);
  for (double x = 0.03; x < 12.0; x += 0.01) {
    const double slope = deep_slope(x);
    EXPECT_GT(slope, 0.0) << x;
    // As Hertz' at first, by 0.5 / x.
    EXPECT_NEAR(slope / before, 1.0, 0.03 + 0.01 * 0.7 / x) << x;
    before = slope;
  }
  for (double f = 0.1; f < 1e3; f *= 1.3) {
    EXPECT_GT(nonlinear_tip_depth_m(kTissue, kRadiusM, 1.01 * f),
              nonlinear_tip_depth_m(kTissue, kRadiusM, f));
  }
}

// Sneddon 1965 of a profile with the slope cot alpha, by the midpoint rule:
//   h = a \int_0^1 cot alpha / sqrt(1 - x^2) dx
//   F = 2 E / (1 - nu^2) a^2 \int_0^1 x^2 cot alpha / sqrt(1 - x^2) dx
TEST(LinearCone, IsSneddonsUntilItsContactIsAsWideAsTheShaft) {
  constexpr int kParts = 2000;
  for (const double half_angle : {0.15, 0.5, 0.9}) {
    double h = 0.0, f = 0.0;
    for (int i = 0; i < kParts; ++i) {  // x = sin s
      const double s = (i + 0.5) * 0.5 * std::numbers::pi / kParts;
      h += 0.5 * std::numbers::pi / kParts / std::tan(half_angle);
      f += 0.5 * std::numbers::pi / kParts / std::tan(half_angle) * std::sin(s) *
           std::sin(s);
    }
    const NeedleTip tip{.radius_m = kRadiusM, .half_angle_rad = half_angle};
    for (const double share : {0.01, 0.3, 1.0}) {
      const double a_m = share * kRadiusM;
      const double force_n = 2.0 * kPlanePa * a_m * a_m * f;
      EXPECT_NEAR(linear_cone_depth_m(kTissue, tip, force_n) / (a_m * h), 1.0, 1e-9)
          << half_angle << " " << share;
      // (2/pi) E / (1 - nu^2) tan alpha h^2
      EXPECT_NEAR(2.0 / std::numbers::pi * kPlanePa * std::tan(half_angle) *
                      std::pow(a_m * h, 2) / force_n,
                  1.0, 1e-9);
    }
  }
  EXPECT_EQ(linear_cone_depth_m(kTissue, {kRadiusM, 0.5}, 0.0), 0.0);
}

TEST(LinearCone, IsAFlatPunchBeyondAndJoinsItWithoutAStep) {
  const NeedleTip tip{.radius_m = kRadiusM, .half_angle_rad = 0.4};
  const double join_n =
      0.5 * std::numbers::pi * kPlanePa * kRadiusM * kRadiusM / std::tan(0.4);
  const double punch_n_per_m = 2.0 * kPlanePa * kRadiusM;
  const auto depth_m = [&](double times) {
    return linear_cone_depth_m(kTissue, tip, times * join_n);
  };
  for (const double times : {1.0, 3.0, 50.0}) {
    EXPECT_NEAR((depth_m(times + 0.1) - depth_m(times)) * punch_n_per_m, 0.1 * join_n,
                1e-9 * join_n)
        << times;
  }
  // h goes as the root of F up to there: on both sides 1e-4 F_R / (2 E R).
  const double step_m = 1e-4 * join_n / punch_n_per_m;
  EXPECT_NEAR((depth_m(1.0) - depth_m(1.0 - 1e-4)) / step_m, 1.0, 1e-4);
  EXPECT_NEAR((depth_m(1.0 + 1e-4) - depth_m(1.0)) / step_m, 1.0, 1e-9);
}

// What scenes may ask for.
TEST(LinearCone, SinksDeeperThanAHemisphereUpTo110Degrees) {
  for (const double angle_deg : {10.0, 60.0, 110.0}) {
    const NeedleTip tip{.radius_m = kRadiusM,
                        .half_angle_rad = 0.5 * angle_deg * std::numbers::pi / 180.0};
    for (double force_n = 1e-6; force_n < 100.0; force_n *= 1.5) {
      EXPECT_GT(linear_cone_depth_m(kTissue, tip, force_n),
                linear_tip_depth_m(kTissue, kRadiusM, force_n))
          << angle_deg << " " << force_n;
    }
  }
}

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
