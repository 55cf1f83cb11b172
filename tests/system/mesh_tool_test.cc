// A body is pressed by a tool whose shape is in a file.
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "formats/database/response_database.h"
#include "tests/support/organ_scene.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr const char* kBoxScene = R"([reach]
box_m = [[-1.0, -1.0, 0.043], [1.0, 1.0, 1.0]]
depth_max_m = 0.003
[accuracy]
force_relative = 0.5
contact_resolution = 0.5
depths = 3
verify = 0
[[tool]]
name = "box"
shape = "mesh"
mesh = "box.obj"
length_unit = "mm"
)";

// A box of 20 mm by 20 mm by 30 mm, from its tip at the origin upwards.
constexpr const char* kBox = R"(
v -10 -10 0
v 10 -10 0
v 10 10 0
v -10 10 0
v -10 -10 30
v 10 -10 30
v 10 10 30
v -10 10 30
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
)";

TEST(MeshTool, PressesTheBody) {
  const ScratchFolder folder;
  const auto path = [&](const char* name) {
    return (folder / name).string();
  };
  std::ofstream(path("scene.toml")) << organ_on_table("linear") << kBoxScene;
  std::ofstream(path("box.obj")) << kBox;
  const ToolRun body =
      run_tool_process("palpate-precompute",
                       {"body", "organ", "--levels", "2", "-o", path("organ.obj")});
  ASSERT_EQ(body.exit_code, 0) << body.err;
  const ToolRun plan =
      run_tool_process("palpate-precompute", {"plan", path("scene.toml")});
  EXPECT_EQ(plan.exit_code, 0) << plan.err;
  const ToolRun built = run_tool_process(
      "palpate-precompute", {"build", path("scene.toml"), "-o", path("out.h5")});
  ASSERT_EQ(built.exit_code, 0) << built.err;
  const ResponseDatabase database = read_database(path("out.h5"));
  const ResponseTable& table = database.tools.at(0);
  int pressed = 0;
  for (Eigen::Index node = 0;
       node < static_cast<Eigen::Index>(table.stiffness_max_n_per_m.size()); ++node) {
    const CurveView curve = table.curve(node);
    if (curve.depth_m.size() >= 2) {
      ++pressed;
      EXPECT_GT(curve.at(0.003).force_n, curve.at(0.0015).force_n) << node;
      EXPECT_GT(curve.at(0.0015).force_n, 0.0) << node;
    }
  }
  EXPECT_GT(pressed, 3);
}

}  // namespace
}  // namespace palpate
