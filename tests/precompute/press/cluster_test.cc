// Which vertices of a cluster are solved before others are interpolated.
#include "precompute/press/cluster.h"

#include <algorithm>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "formats/mesh/obj_writer.h"
#include "precompute/press/scene_solver.h"
#include "tests/support/odd_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// The flat top of a soft block with its edges and corners, pressed so lightly and with
// so wide a budget that whatever was solved first is within it.
constexpr const char* kScene = R"([body]
mesh = "block.obj"
length_unit = "m"
[[material]]
region = "body"
law = "neo-hookean"
youngs_modulus_pa = 5000.0
poissons_ratio = 0.4
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, -0.0199]]
[[tool]]
name = "ball"
shape = "sphere"
radius_m = 0.006
[reach]
box_m = [[-1.0, -1.0, -0.0001], [1.0, 1.0, 1.0]]
depth_max_m = 0.003
[accuracy]
force_relative = 0.5
contact_resolution = 1.0
depths = 3
verify = 0
)";

struct Answers {
  BodySource body;
  std::vector<WorkUnitNode> nodes;
};

Answers answers_of(const std::string& scene_text) {
  const ScratchFolder folder;
  write_obj(relief(0.04, -0.02, 6,
                   [](double, double) {
                     return 0.0;
                   }),
            folder / "block.obj", "");
  std::ofstream(folder / "scene.toml") << scene_text;
  const Scene scene = read_scene(folder / "scene.toml");
  Answers answers{.body = read_body(scene), .nodes = {}};
  const BodySource& body = answers.body;
  const std::vector<std::int32_t> vertices = reachable_vertices(scene, body);
  const PressStrategy strategy = choose_strategy(scene, body, vertices);
  Progress progress(nullptr);
  const SceneSolver solver(scene, body, strategy, vertices, vertices, progress);
  Cluster cluster(scene, body, solver, body.tool.front(), vertices);
  cluster.solve_linear();
  cluster.solve_within_budget();
  cluster.answer(0, answers.nodes);
  return answers;
}

// Solved or interpolated, a curve ends at the largest force, at the largest depth, or
// it says that it does not.
TEST(Cluster, CurvesEndAtALimitOrSayThatTheyDoNot) {
  constexpr double kForceMax = 0.03;
  std::string text = kScene;
  text.replace(text.find("depths = 3"), 10, "depths = 12");
  text.replace(text.find("depth_max_m = 0.003"), 19,
               "depth_max_m = 0.003\nforce_max_n = 0.03");
  int interpolated = 0;
  int capped = 0;
  for (const WorkUnitNode& node : answers_of(text).nodes) {
    const NodeResponse& response = node.response;
    if (response.depth_m.empty()) {
      continue;
    }
    interpolated += response.origin == ResponseOrigin::kInterpolated ? 1 : 0;
    const bool at_force = response.force_n.back() > kForceMax;
    capped += at_force ? 1 : 0;
    EXPECT_EQ((response.flags & kForceCapped) != 0, at_force) << node.vertex;
    const bool at_depth = response.depth_m.size() == 13;
    EXPECT_TRUE(at_force || at_depth || !node.failure.empty() ||
                (response.flags & kTruncatedPath) != 0)
        << "vertex " << node.vertex << " ends at " << response.force_n.back() << " N";
  }
  EXPECT_GT(interpolated, 5);
  EXPECT_GT(capped, 5);
}

// What a solve tried is kept; what was interpolated was not solved.
TEST(Cluster, KeepsTheHistoryOfWhatItSolves) {
  int again = 0;
  for (const WorkUnitNode& node : answers_of(kScene).nodes) {
    again += node.history.empty() ? 0 : 1;
    if (node.response.origin == ResponseOrigin::kInterpolated) {
      EXPECT_EQ(node.history, "") << node.vertex;
    }
  }
  EXPECT_GT(again, 0);
}

// A budget of so many deviations of every vertex' error that one in twenty is beyond it
// (1.96 for two sides) is kept, a little less is not.
TEST(Cluster, KeepsABudgetAtNinetyFivePercent) {
  const std::vector<double> expected(40, 0.03);
  const double quantile = 1.9599639845 * 0.03 / kExpectedDeviations;
  EXPECT_TRUE(keeps_budget(expected, 19, 1.0001 * quantile));
  EXPECT_FALSE(keeps_budget(expected, 19, 0.9999 * quantile));
  // Of twice as many, half of them solved, one in ten of the others may be beyond.
  std::vector<double> half = expected;
  half.resize(80, 0.0);
  const double tenth = 1.6448536270 * 0.03 / kExpectedDeviations;
  EXPECT_TRUE(keeps_budget(half, 19, 1.0001 * tenth));
  EXPECT_FALSE(keeps_budget(half, 19, 0.9999 * tenth));
}

TEST(Cluster, KeepsABudgetEverywhereWhereFewRatiosAreKnown) {
  std::vector<double> expected(40, 0.001);
  expected[7] = 0.03;
  EXPECT_TRUE(keeps_budget(expected, 19, 0.04));
  EXPECT_FALSE(keeps_budget(expected, 18, 0.0449));
  EXPECT_TRUE(keeps_budget(expected, 18, 0.0451));
}

TEST(Cluster, SolvesOtherKindsOfPlacesBeforeOthersAreInterpolated) {
  const auto [body, nodes] = answers_of(kScene);
  std::vector<std::int32_t> solved;
  for (const WorkUnitNode& node : nodes) {
    if (node.response.origin == ResponseOrigin::kSimulated) {
      solved.push_back(node.vertex);
    }
  }
  EXPECT_LE(solved.size(), kFirstSamples + kOtherKinds);
  ASSERT_LT(solved.size(), nodes.size());
  for (const WorkUnitNode& node : nodes) {
    EXPECT_TRUE(std::any_of(
        solved.begin(), solved.end(),
        [&](std::int32_t s) {
          return (body.normal.row(s) - body.normal.row(node.vertex)).norm() < 0.4;
        }))
        << "nothing that faces as vertex " << node.vertex << " was solved";
  }
}

}  // namespace
}  // namespace palpate
