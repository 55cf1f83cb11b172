// Scenes at the ends of what can be asked: the right force, or a refusal in one
// sentence.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

// A cube of side 1, z up, with a vertex in the middle of its top.
constexpr double kCorner[9][3] = {{0, 0, 0},    {1, 0, 0}, {1, 1, 0}, {0, 1, 0},  //
                                  {0, 0, 1},    {1, 0, 1}, {1, 1, 1}, {0, 1, 1},  //
                                  {0.5, 0.5, 1}};
constexpr const char* kFaces =
    "f 1 4 3 2\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 9\nf 6 7 9\n"
    "f 7 8 9\nf 8 5 9\n";

// The cube, held at its bottom, and a ball on its top.
struct Press {
  double side_m = 1.0;
  double thickness = 1.0;  // of the cube, in sides
  std::string law = "linear";
  double youngs_modulus_pa = 1000.0;
  double poissons_ratio = 0.3;
  double radius = 0.3;  // of the ball, in sides
  double depth = 0.05;  // in sides
  double resolution = 2.0;
  int depths = 6;
  std::string support = {};  // instead of the fixed bottom
  std::string more = {};     // of the scene
};

// The budget is tighter than what is tested: a press is as exact as that asks for.
std::string scene_of(const Press& p) {
  const std::string bottom = fmt::format(
      "[[support]]\nplane = {{ point_m = [0.0, 0.0, 0.0], normal = [0.0, "
      "0.0, 1.0] }}\n");
  return fmt::format(R"([body]
mesh = "cube.obj"
length_unit = "m"
[[material]]
region = "body"
law = "{}"
youngs_modulus_pa = {:.17e}
poissons_ratio = {:.17e}
{}[[tool]]
name = "ball"
shape = "sphere"
radius_m = {:.17e}
[reach]
depth_max_m = {:.17e}
[accuracy]
force_relative = 0.02
contact_resolution = {:.17e}
depths = {}
{})",
                     p.law, p.youngs_modulus_pa, p.poissons_ratio,
                     p.support.empty() ? bottom : p.support, p.radius * p.side_m,
                     p.depth * p.side_m, p.resolution, p.depths, p.more);
}

ToolRun run(const Press& press) {
  const ScratchFolder folder;
  std::ofstream body(folder / "cube.obj");
  for (const auto& x : kCorner) {
    body << fmt::format("v {:.17e} {:.17e} {:.17e}\n", x[0] * press.side_m,
                        x[1] * press.side_m, x[2] * press.side_m * press.thickness);
  }
  body << kFaces;
  body.close();
  std::ofstream(folder / "scene.toml") << scene_of(press);
  return run_tool_process(
      "palpate-precompute",
      {"indent", (folder / "scene.toml").string(), "--vertex", "8", "--json"});
}

struct Response {
  std::vector<double> depth_m;
  std::vector<double> force_n;  // along the outward normal
  std::vector<double> energy_j;
  bool near_singular = false;
  std::string failure = {};
  [[nodiscard]] double last_n() const { return force_n.back(); }
};

// Work from sample k - 1 to k: exact where the force is a power of the depth, from zero
// that of the next two samples.
double work_between_j(const Response& r, std::size_t k) {
  const std::size_t at = k == 1 && r.force_n.size() > 2 ? 2 : k;
  const double exponent = at == 1 ? 1.0
                                  : std::log(r.force_n[at] / r.force_n[at - 1]) /
                                        std::log(r.depth_m[at] / r.depth_m[at - 1]);
  return (r.force_n[k] * r.depth_m[k] - r.force_n[k - 1] * r.depth_m[k - 1]) /
         (exponent + 1.0);
}

// What is true of every response: finite, and the work done is the energy stored.
void expect_sound(const Response& r) {
  double work_j = 0.0;
  for (std::size_t k = 0; k < r.force_n.size(); ++k) {
    ASSERT_TRUE(std::isfinite(r.force_n[k]) && std::isfinite(r.energy_j[k]));
    if (k > 0) {
      EXPECT_GT(r.force_n[k], 0.0);
      EXPECT_GT(r.energy_j[k], r.energy_j[k - 1]);
      work_j += work_between_j(r, k);
    }
  }
  // Springs that keep a hard press from folding into the tool take energy that is not
  // the body's.
  EXPECT_NEAR(work_j / r.energy_j.back(), 1.0, r.near_singular ? 0.1 : 0.01);
}

Response respond(const Press& press) {
  const ToolRun result = run(press);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const Json report = result.exit_code == 0 ? parse_json(result.out) : Json();
  if (report.empty()) {
    return {{0.0}, {NAN}, {NAN}, false, result.err};
  }
  Response r{report.at("depth_m"),
             {},
             report.at("energy_j"),
             report.at("near_singular"),
             report.value("failure", "")};
  for (const Json& force : report.at("force_vector_n")) {
    r.force_n.push_back(force.at(2));
  }
  expect_sound(r);
  return r;
}

void expect_refused(const Press& press, const std::string& says) {
  const ToolRun result = run(press);
  EXPECT_TRUE(result.exit_code == 2 || result.exit_code == 4) << result.exit_code;
  const auto at = result.err.find("palpate-precompute: error: ");
  ASSERT_NE(at, std::string::npos) << result.err << result.out;
  const std::string message = result.err.substr(at);
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 1) << message;
  EXPECT_NE(message.find(says), std::string::npos) << message;
}

class ExtremesByLaw : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(
    Laws, ExtremesByLaw, testing::Values("linear", "neo-hookean"), [](const auto& law) {
      return std::string(law.param == std::string("linear") ? "Linear" : "NeoHookean");
    });

TEST_P(ExtremesByLaw, ForceScalesWithTheModulusFromOnePascalToATerapascal) {
  const Response middle = respond({.law = GetParam()});
  for (const double modulus_pa : {1.0, 1e12}) {
    const Response r = respond({.law = GetParam(), .youngs_modulus_pa = modulus_pa});
    // The problem's numbers are the same but for one factor; what is left is rounding,
    // which Newton's method may turn into a different last step.
    EXPECT_NEAR(r.last_n() / middle.last_n() * 1000.0 / modulus_pa, 1.0, 1e-6);
  }
}

TEST_P(ExtremesByLaw, ForceScalesWithTheAreaFromAMicrometreToAHundredMetres) {
  const Response one = respond({.law = GetParam()});
  const auto relative = [&](double side_m) {
    return respond({.side_m = side_m, .law = GetParam()}).last_n() / (side_m * side_m) /
           one.last_n();
  };
  // Powers of four change nothing but exponents, in a factor's roots, too.
  EXPECT_NEAR(relative(std::exp2(-20)), 1.0, 1e-9);
  EXPECT_NEAR(relative(std::exp2(6)), 1.0, 1e-9);
  // Other roots are rounded: a number that is rounded to single precision may become
  // its neighbour, 1e-7 off.
  EXPECT_NEAR(relative(std::exp2(7)), 1.0, 1e-7);
  // Rounding makes other tets; the budget is 10 %, of which they take a part.
  EXPECT_NEAR(relative(1e-6), 1.0, 0.02);
  EXPECT_NEAR(relative(100.0), 1.0, 0.02);
}

TEST_P(ExtremesByLaw, AnyPoissonsRatioHasAForceThatGoesOnSmoothly) {
  std::vector<double> force_n;
  for (const double nu : {-0.9, 0.0, 0.45, 0.499, 0.4999}) {
    force_n.push_back(
        respond({.law = GetParam(), .poissons_ratio = nu, .depth = 0.05}).last_n());
  }
  // At one Young's modulus the shear modulus E / (2 (1 + nu)) of -0.9 is ten times that
  // of 0; a locked element would be stiffer by orders of magnitude at 0.4999.
  EXPECT_GT(force_n[0], force_n[1]);
  EXPECT_NEAR(force_n[4] / force_n[3], 1.0, 0.02);
  EXPECT_NEAR(force_n[3] / force_n[2], 1.1, 0.15);
}

TEST(Extremes, SmallDepthsAreLinearAtAnyPoissonsRatio) {
  for (const double nu : {-0.9, 0.0, 0.4999}) {
    Press press{.poissons_ratio = nu, .radius = 2.0, .depth = 0.004};
    const double linear_n = respond(press).last_n();
    press.law = "neo-hookean";
    // Strains of about depth / contact radius, some 3 %, and as much of the force.
    EXPECT_NEAR(respond(press).last_n() / linear_n, 1.0, 0.05) << nu;
  }
}

std::string ball_inside(double youngs_modulus_pa, bool cavity) {
  const std::string ball =
      "[[inclusion]]\nname = \"nodule\"\nsphere = { center_m = [0.5, 0.5, 0.6], "
      "radius_m = 0.2 }\n";
  return cavity ? ball + "cavity = true\n"
                : ball + fmt::format(
                             "[[material]]\nregion = \"nodule\"\nlaw = "
                             "\"linear\"\nyoungs_modulus_pa = "
                             "{:.17e}\npoissons_ratio = 0.3\n",
                             youngs_modulus_pa);
}

TEST(Extremes, AnInclusionAMillionTimesSofterIsAHoleAndStifferIsRigid) {
  const auto with = [](double contrast) {
    return respond({.more = ball_inside(1000.0 * contrast, false)}).last_n();
  };
  const double hole_n = respond({.more = ball_inside(0.0, true)}).last_n();
  const double same_n = with(1.0);
  EXPECT_NEAR(with(1e-6) / hole_n, 1.0, 1e-3);
  // Nothing changes any more between a thousand and a million but by a thousandth.
  EXPECT_NEAR(with(1e6) / with(1e4), 1.0, 1e-3);
  EXPECT_LT(hole_n, 0.99 * same_n);
  EXPECT_GT(with(1e6), 1.01 * same_n);
}

TEST(Extremes, ABallOfATenthOfAnElementMeetsAHalfSpace) {
  // Edges of the body are 1 and 0.7.
  const double R = 0.07;
  const double d = 0.007;
  const Response r = respond({.radius = R, .depth = d, .resolution = 6.0});
  const double hertz_n =
      4.0 / 3.0 * 1000.0 / (1.0 - 0.3 * 0.3) * std::sqrt(R) * std::pow(d, 1.5);
  // Hertz's contact radius is 0.02 of the side; the mesh is allowed 10 %.
  EXPECT_NEAR(r.last_n() / hertz_n, 1.0, 0.1);
}

TEST(Extremes, ABallOfTenTimesTheBodyPressesLikeAPlate) {
  // The cube's diagonal is 1.73.
  const double d = 0.02;
  const Response r = respond({.radius = 17.0, .depth = d});
  const double free_n = 1000.0 * d;  // modulus times strain, sides free to bulge
  const double confined_n = free_n * (1.0 - 0.3) / ((1.0 + 0.3) * (1.0 - 0.6));
  // The ball's rim is 0.5^2 / (2 * 17) = 0.007 higher than its tip.
  EXPECT_GT(r.last_n(), free_n * (1.0 - 0.015 / d));
  EXPECT_LT(r.last_n(), confined_n);
  expect_refused({.radius = 18.0}, "larger than the body");
}

TEST_P(ExtremesByLaw, DepthsOfFourFifthsOfTheThicknessAreReachedOrTheReasonIsSaid) {
  const double thickness = 0.5;
  const Response r = respond({.thickness = thickness,
                              .law = GetParam(),
                              .poissons_ratio = 0.45,
                              .radius = 0.5,
                              .depth = 0.8 * thickness,
                              .depths = 24});
  if (r.failure.empty()) {
    EXPECT_NEAR(r.depth_m.back(), 0.8 * thickness, 1e-12);
  } else {
    EXPECT_EQ(r.failure.find('\n'), std::string::npos);
    EXPECT_LT(r.depth_m.back(), 0.8 * thickness);
  }
}

TEST(Extremes, DepthsOfMoreThanTheBodyAreRefused) {
  expect_refused({.depth = 2.0}, "more than the body's extent");
}

TEST(Extremes, NothingThatHoldsTheBodyIsSaid) {
  expect_refused({.support = "[[support]]\nbox_m = [[5.0, 5.0, 5.0], [6.0, 6.0, "
                             "6.0]]\n"},
                 "support");
}

TEST(Extremes, OneHeldLineIsSaidToLeaveTheBodyLoose) {
  // It turns about the edge x = 0, z = 0.
  expect_refused({.support = "[[support]]\nbox_m = [[-0.001, -1.0, -0.001], [0.001, "
                             "2.0, 0.001]]\n"},
                 "support");
}

TEST(Extremes, SupportsThatHoldAllOfItAreSaid) {
  expect_refused({.support = "[[support]]\nbox_m = [[-1.0, -1.0, -1.0], [2.0, 2.0, "
                             "2.0]]\n"},
                 "held by a support");
}

TEST_P(ExtremesByLaw, AFoundationAloneHoldsTheBody) {
  const double k = 0.01;  // [Pa/m] the body is rigid beside it
  const Response r = respond(
      {.law = GetParam(),
       .support = fmt::format("[[support]]\nkind = \"foundation\"\nstiffness_pa_per_m "
                              "= {}\nbox_m = [[-1.0, -1.0, -0.001], [2.0, 2.0, "
                              "0.001]]\n",
                              k)});
  // Springs under an area of 1: the force grows by k with the depth.
  const std::size_t n = r.depth_m.size();
  const double slope =
      (r.force_n[n - 1] - r.force_n[n - 2]) / (r.depth_m[n - 1] - r.depth_m[n - 2]);
  EXPECT_NEAR(slope / k, 1.0, 0.01);
}

}  // namespace
}  // namespace palpate
