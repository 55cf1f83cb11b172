// Which vertices of a territory are solved before others are interpolated.
#include "precompute/press/territory.h"

#include <algorithm>
#include <fstream>
#include <memory>

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

TEST(Territory, SolvesOtherKindsOfPlacesBeforeOthersAreInterpolated) {
  const ScratchFolder folder;
  write_obj(relief(0.04, -0.02, 6,
                   [](double, double) {
                     return 0.0;
                   }),
            folder / "block.obj", "");
  std::ofstream(folder / "scene.toml") << kScene;
  const Scene scene = read_scene(folder / "scene.toml");
  const BodySource body = read_body(scene);
  const std::vector<std::int32_t> vertices = reachable_vertices(scene, body);
  const PressStrategy strategy = choose_strategy(scene, body, vertices);
  Progress progress(nullptr);
  const SceneSolver solver(scene, body, strategy, vertices, vertices, progress);
  Territory territory(scene, body, solver, body.tool.front(), vertices);
  territory.press_cheap();
  territory.solve_within_budget();
  std::vector<WorkUnitNode> nodes;
  territory.answer(0, nodes);
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
