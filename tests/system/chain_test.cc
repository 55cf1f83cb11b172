// From a surface mesh to a force on a device, by the tools that a user runs.

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/database/response_database.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

constexpr const char* kCube = R"(
v 0 0 0
v 40 0 0
v 40 40 0
v 0 40 0
v 0 0 40
v 40 0 40
v 40 40 40
v 0 40 40
v 20 20 40
f 1 4 3 2
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
f 5 6 9
f 6 7 9
f 7 8 9
f 8 5 9
)";

std::string scene_text(const std::string& mesh, const std::string& unit) {
  return "[body]\nmesh = \"" + mesh + "\"\nlength_unit = \"" + unit + R"("
[[material]]
region = "body"
law = "linear"
youngs_modulus_pa = 6000.0
poissons_ratio = 0.4
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, 0.001]]
kind = "fixed"
[[tool]]
name = "ball"
shape = "sphere"
radius_m = 0.01
friction = 0.3
presliding_m = 0.0005
[reach]
box_m = [[-1.0, -1.0, 0.039], [1.0, 1.0, 1.0]]
depth_max_m = 0.004
force_max_n = 8.0
[accuracy]
force_relative = 0.1
verify = 1
)";
}

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

// A database of a small cube, built once for all tests of this file.
class Chain : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<ScratchFolder>();
    write(*folder_ / "cube.obj", kCube);
    write(*folder_ / "cube.toml", scene_text("cube.obj", "mm"));
    build_ = run_tool_process("palpate-precompute",
                              {"build", scene(), "-o", database(), "--json"});
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::string scene() { return (*folder_ / "cube.toml").string(); }
  static std::string database() { return (*folder_ / "cube.h5").string(); }
  static std::unique_ptr<ScratchFolder> folder_;
  static ToolRun build_;
};
std::unique_ptr<ScratchFolder> Chain::folder_;
ToolRun Chain::build_;

TEST_F(Chain, BuildReportsWhatItSolved) {
  ASSERT_EQ(build_.exit_code, 0) << build_.err;
  const Json report = parse_json(build_.out);
  EXPECT_EQ(report.at("nodes"), 9);
  EXPECT_EQ(report.at("solved"), 5);  // four corners and the middle of the top
  EXPECT_EQ(report.at("failed"), 0);
  EXPECT_EQ(report.at("interpolated"), 0);
  EXPECT_GT(report.at("seconds"), 0.0);
  EXPECT_GT(report.at("peak_memory_bytes"), 1000000);
}

TEST_F(Chain, TheSameSceneGivesTheSameBytes) {
  const std::string again = (*folder_ / "again.h5").string();
  const ToolRun second =
      run_tool_process("palpate-precompute", {"build", scene(), "-o", again});
  ASSERT_EQ(second.exit_code, 0) << second.err;
  EXPECT_TRUE(bytes_of(database()) == bytes_of(again));
}

// Each on a mesh of its own, both within the scene's budget.
TEST_F(Chain, IndentAgreesWithWhatBuildStored) {
  const ToolRun run = run_tool_process(
      "palpate-precompute", {"indent", scene(), "--at", "0.02,0.02,0.04", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json report = parse_json(run.out);
  EXPECT_EQ(report.at("vertex"), 8);
  EXPECT_NEAR(report.at("inward_normal").at(2).get<double>(), -1.0, 1e-12);
  const ResponseDatabase stored = read_database(database());
  const CurveView curve = stored.tools.at(0).curve(8);
  const std::vector<double> depth = report.at("depth_m");
  const std::vector<double> force = report.at("force_n");
  ASSERT_EQ(depth.size(), force.size());
  for (std::size_t k = 0; k < force.size(); ++k) {
    EXPECT_NEAR(curve.at(depth[k]).force_n, force[k], 0.1 * force.back()) << depth[k];
    const Eigen::Vector3d vector(report["force_vector_n"][k][0],
                                 report["force_vector_n"][k][1],
                                 report["force_vector_n"][k][2]);
    EXPECT_NEAR(vector.norm(), force[k], 1e-12);
  }
  EXPECT_NEAR(report.at("energy_j").back(), curve.energy_j.back(),
              0.1 * curve.energy_j.back());
}

TEST_F(Chain, InfoAndCheckReadTheDatabase) {
  const ToolRun info = run_tool_process("palpate-db", {"info", database(), "--json"});
  ASSERT_EQ(info.exit_code, 0) << info.err;
  const Json report = parse_json(info.out);
  EXPECT_EQ(report.at("format_version"), 2);
  EXPECT_EQ(report.at("nodes"), 9);
  EXPECT_EQ(report.at("triangles"), 14);
  EXPECT_EQ(report.at("tools").at(0), "ball");
  EXPECT_GT(report.at("depth_max_m"), 0.002);
  EXPECT_EQ(report.at("bytes"), std::filesystem::file_size(database()));
  EXPECT_EQ(run_tool_process("palpate-db", {"check", database()}).exit_code, 0);
}

TEST_F(Chain, EveryLocalModelRendersTheDatabase) {
  for (const char* model : {"single", "first-order-hold", "equal-energy", "energy-tank",
                            "element", "potential"}) {
    const ToolRun run = run_tool_process(
        "palpate-run", {"simulate", database(), "--model", model, "--seconds", "2",
                        "--clock", "simulated", "--json"});
    ASSERT_EQ(run.exit_code, 0) << model << ": " << run.err;
    EXPECT_TRUE(parse_json(run.out).is_object()) << model;
  }
}

// What it had solved is kept whole, and nothing else.
TEST_F(Chain, AnInterruptedBuildLeavesNoFileAndGoesOnToTheSameBytes) {
  const ScratchFolder out;
  const std::string file = (out / "half.h5").string();
  const std::string partial = file + ".partial";
  const ToolRun run = kill_tool_process(
      "palpate-precompute", {"build", scene(), "-o", file},
      [&] {
        return std::filesystem::exists(partial);
      },
      SIGINT);
  EXPECT_EQ(run.exit_code, 130) << run.err;
  EXPECT_FALSE(std::filesystem::exists(file));
  const ToolRun rest = run_tool_process("palpate-precompute",
                                        {"build", scene(), "-o", file, "--resume"});
  ASSERT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_TRUE(bytes_of(file) == bytes_of(database()));
  EXPECT_FALSE(std::filesystem::exists(partial));
}

TEST_F(Chain, TwoDistinctNodesAreNotOneCurve) {
  const ResponseDatabase stored = read_database(database());
  const ResponseTable& table = stored.tools.at(0);
  // The corner of the cube yields more than the middle of its top.
  EXPECT_LT(table.curve(4).at(0.003).force_n, 0.8 * table.curve(8).at(0.003).force_n);
}

// A liver of human size, held at its back.
std::string liver_scene(const std::filesystem::path& mesh) {
  return "[body]\nmesh = \"" + mesh.string() + R"("
length_unit = "dm"
[[material]]
region = "body"
law = "linear"
youngs_modulus_pa = 5000.0
poissons_ratio = 0.45
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, 1.46]]
kind = "fixed"
[[tool]]
name = "ball"
shape = "sphere"
radius_m = 0.015
[reach]
depth_max_m = 0.005
force_max_n = 8.0
[accuracy]
force_relative = 0.2
refine = "global"
contact_resolution = 0.5
depths = 6
verify = 1
)";
}

TEST(RealOrgan, BuildsAndItsDatabaseHolds) {
  const auto mesh = test_data("meshes/sofa_liver2.obj");
  if (!mesh) {
    GTEST_SKIP() << "no test data: meshes/sofa_liver2.obj";
  }
  const ScratchFolder folder;
  write(folder / "liver.toml", liver_scene(*mesh));
  const std::string database = (folder / "liver.h5").string();
  const ToolRun build = run_tool_process(
      "palpate-precompute",
      {"build", (folder / "liver.toml").string(), "-o", database, "--json"});
  ASSERT_EQ(build.exit_code, 0) << build.err;
  const Json report = parse_json(build.out);
  EXPECT_EQ(report.at("nodes"), 1170);
  EXPECT_GT(report.at("tets"), 1000) << "of the mesh that all nodes share";
  EXPECT_EQ(report.at("failed"), 0);
  EXPECT_GT(report.at("solved"), 1000);
  EXPECT_EQ(run_tool_process("palpate-db", {"check", database}).exit_code, 0);
  const ToolRun run = run_tool_process(
      "palpate-run", {"simulate", database, "--seconds", "5", "--clock", "simulated"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

TEST(RealOrgan, ThatCutsItselfIsRefusedWithTheNumberOfPlaces) {
  const auto mesh = test_data("meshes/sofa_liver-smooth.obj");
  if (!mesh) {
    GTEST_SKIP() << "no test data: meshes/sofa_liver-smooth.obj";
  }
  const ScratchFolder folder;
  write(folder / "liver.toml", liver_scene(*mesh));
  const ToolRun build =
      run_tool_process("palpate-precompute", {"build", (folder / "liver.toml").string(),
                                              "-o", (folder / "liver.h5").string()});
  EXPECT_EQ(build.exit_code, 2);
  EXPECT_NE(build.err.find("7 self-intersecting"), std::string::npos) << build.err;
}

TEST_F(Chain, AnOutputThatCannotBeWrittenIsSaidBeforeTheWork) {
  const ToolRun run = run_tool_process(
      "palpate-precompute", {"build", scene(), "-o", "/nonexistent-folder/out.h5"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err.rfind("palpate-precompute: error: /nonexistent-folder", 0), 0U)
      << run.err;
}

struct BadInput {
  const char* what;
  std::string mesh;
  std::string scene;
  int exit_code;
  const char* says;
};

std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(BadScenes, AreRefusedInOneLineThatNamesTheDefectAndLeaveNothingBehind) {
  const std::string good = scene_text("body.obj", "mm");
  const std::string open = with(kCube, "f 8 5 9\n", "");
  const std::string crossing = with(kCube, "v 20 20 40", "v 20 20 -15");
  const std::vector<BadInput> cases{
      {"open surface", open, good, 2, "open"},
      {"self-intersection", crossing, good, 2, "intersect"},
      {"missing mesh", kCube, with(good, "body.obj", "nobody.obj"), 2, "nobody.obj"},
      {"unknown format", kCube, with(good, "body.obj", "body.xyz"), 2, "xyz"},
      {"zero modulus", kCube, with(good, "6000.0", "0.0"), 2, "youngs_modulus_pa"},
      {"NaN modulus", kCube, with(good, "6000.0", "nan"), 2, "youngs_modulus_pa"},
      {"negative radius", kCube, with(good, "radius_m = 0.01", "radius_m = -0.01"), 2,
       "radius_m"},
      {"incompressible", kCube,
       with(good, "poissons_ratio = 0.4", "poissons_ratio = 0.5"), 2, "poissons_ratio"},
      {"large tool", kCube, with(good, "radius_m = 0.01", "radius_m = 1.0"), 2,
       "larger than the body"},
      {"unknown key", kCube, with(good, "depth_max_m", "depth_maxx_m"), 2,
       "depth_max_m"},
      {"unknown law", kCube, with(good, "\"linear\"", "\"rubber\""), 2, "neo-hookean"},
      {"unknown tool", kCube, with(good, "\"sphere\"", "\"spoon\""), 2, "sphere"},
      {"unknown unit", kCube, scene_text("body.obj", "furlong"), 2, "furlong"},
      {"held nowhere", kCube,
       with(good, "-1.0, -1.0], [1.0, 1.0, 0.001]", "-1.0, -1.0], [1.0, 1.0, -0.9]"), 2,
       "support"},
      {"held everywhere", kCube, with(good, "[1.0, 1.0, 0.001]", "[1.0, 1.0, 1.0]"), 2,
       "reach"},
      {"reach misses", kCube, with(good, "0.039]", "0.9]"), 2, "reach"},
      {"not TOML", kCube, "[body\n", 2, "scene.toml"},
  };
  for (const BadInput& bad : cases) {
    const ScratchFolder folder;
    write(folder / "body.obj", bad.mesh);
    write(folder / "body.xyz", bad.mesh);
    write(folder / "scene.toml", bad.scene);
    const ToolRun run = run_tool_process(
        "palpate-precompute", {"build", (folder / "scene.toml").string(), "-o",
                               (folder / "out.h5").string()});
    EXPECT_EQ(run.exit_code, bad.exit_code) << bad.what << "\n" << run.err;
    const auto error = run.err.find("palpate-precompute: error: ");
    ASSERT_NE(error, std::string::npos) << bad.what << "\n" << run.err;
    const std::string message = run.err.substr(error);
    EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 1)
        << bad.what << message;
    EXPECT_NE(message.find(bad.says), std::string::npos) << bad.what << "\n" << message;
    EXPECT_FALSE(std::filesystem::exists(folder / "out.h5")) << bad.what;
  }
}

TEST(BadScenes, AnInsideOutSurfaceIsTurnedAndThatIsSaid) {
  const ScratchFolder folder;
  std::string turned;
  std::istringstream lines(kCube);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("f ", 0) == 0) {
      std::istringstream words(line.substr(2));
      std::vector<std::string> corners{std::istream_iterator<std::string>(words), {}};
      line = "f";
      for (auto it = corners.rbegin(); it != corners.rend(); ++it) {
        line += " " + *it;
      }
    }
    turned += line + "\n";
  }
  write(folder / "body.obj", turned);
  write(folder / "scene.toml", scene_text("body.obj", "mm"));
  const ToolRun run = run_tool_process(
      "palpate-precompute",
      {"build", (folder / "scene.toml").string(), "-o", (folder / "out.h5").string()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("inside out"), std::string::npos) << run.out;
}

TEST(BadDatabases, AreRefusedByEveryReader) {
  const ScratchFolder folder;
  write(folder / "text.h5", "this is not HDF5\n");
  const std::string text = (folder / "text.h5").string();
  const std::string missing = (folder / "missing.h5").string();
  for (const auto& [tool, command] : {std::pair{"palpate-db", "info"},
                                      {"palpate-db", "check"},
                                      {"palpate-run", "simulate"}}) {
    const ToolRun foreign = run_tool_process(tool, {command, text});
    EXPECT_EQ(foreign.exit_code, 3) << foreign.err;
    EXPECT_NE(foreign.err.find("text.h5"), std::string::npos) << foreign.err;
    const ToolRun none = run_tool_process(tool, {command, missing});
    EXPECT_EQ(none.exit_code, 2) << none.err;
    EXPECT_NE(none.err.find("missing.h5"), std::string::npos) << none.err;
  }
}

TEST(Devices, NothingAttachedIsSaidAndIsNoError) {
  const ToolRun run = run_tool_process("palpate-run", {"devices"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_FALSE(run.out.empty());
}

}  // namespace
}  // namespace palpate
