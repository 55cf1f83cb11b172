// palpate-fit insertion as a user runs it, with wrong input too.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/scene/scene.h"
#include "tests/fitting/insertion/needle_simulation.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class InsertionTool : public testing::Test {
 protected:
  InsertionTool() {
    tissue_.layers = {{0.0, 2.0, 0.5, 20.0}, {6e-3, 1.0, 0.25, 30.0}};
    write("both.csv", {.deepest_m = {18e-3, 22e-3}}, true);
  }

  void write(const std::string& name, const SimulatedRun& run, bool timed,
             double sign = 1.0) const {
    SimulatedNeedle needle(tissue_);
    const Measurement m = simulate_insertion(needle, run, 1);
    std::ofstream file(folder_ / name);
    file << (timed ? "Depth (mm),Force (N),Time (s)\n" : "Depth (mm),Force (N)\n");
    for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
      file << fmt::format("{},{}", sign * m.depth_m[i] * 1e3, m.force_n[i])
           << (timed ? fmt::format(",{}\n", m.time_s[i]) : "\n");
    }
  }

  ToolRun run(const std::vector<std::string>& files,
              const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"insertion"};
    for (const std::string& file : files) {
      arguments.push_back(folder_ / file);
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_tool_process("palpate-fit", arguments);
  }

  SimulatedTissue tissue_;
  ScratchFolder folder_;
};

TEST_F(InsertionTool, PrintsEveryPartWithItsInterval) {
  const ToolRun result = run({"both.csv"}, {"--edge-width-mm", "1.5"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (const char* part : {"pass 2", "exponent n", "rupture force", "cutting force",
                           "shaft friction", "toughness", "static ratio", "drift"}) {
    EXPECT_NE(result.out.find(part), std::string::npos) << part << "\n" << result.out;
  }
  EXPECT_EQ(result.out.find("not separated"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("warning"), std::string::npos) << result.out;
}

TEST_F(InsertionTool, ReportsForPrograms) {
  const ToolRun result = run({"both.csv"}, {"--json", "--edge-width-mm", "0.1"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = parse_json(result.out);
  EXPECT_EQ(json.at("passes").size(), 2U);
  ASSERT_EQ(json.at("layers").size(), 2U);
  const auto& cutting = json.at("layers").at(0).at("cutting_n");
  EXPECT_NEAR(cutting.at("value"), 0.5, 0.02);
  EXPECT_LT(cutting.at("interval_95").at(0), cutting.at("interval_95").at(1));
  const auto& layer = json.at("layers").at(0);
  EXPECT_NEAR(layer.at("toughness_j_per_m2").at("value"), 5000.0, 200.0);
  EXPECT_NE(layer.at("warning").get<std::string>().find("Tear"), std::string::npos);
  EXPECT_FALSE(json.at("layers").at(1).contains("warning"));
}

// Its file, with what a measurement does not tell, is a scene.
TEST_F(InsertionTool, WritesTheKeysOfAScene) {
  const ToolRun result =
      run({"both.csv"}, {"--edge-width-mm", "0.5", "--scene", folder_ / "part.toml"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::string text = bytes_of(folder_ / "part.toml");
  const std::string elastic =
      "law = \"linear\"\nyoungs_modulus_pa = 15000.0\npoissons_ratio = 0.45\nregion";
  for (std::size_t at = 0; (at = text.find("\nregion", at)) != std::string::npos;) {
    text.replace(at + 1, 6, elastic);
    at += elastic.size() + 1;
  }
  std::ofstream(folder_ / "scene.toml")
      << "[body]\nmesh = \"body.obj\"\nlength_unit = \"m\"\n[[support]]\nbox_m = "
         "[[-1, -1, -1], [1, 1, -0.02]]\n[reach]\ndepth_max_m = 0.004\n"
      << text << "radius_m = 0.0005\n";
  const Scene scene = read_scene(folder_ / "scene.toml");
  ASSERT_EQ(scene.material.size(), 2U);
  const auto of = [&](const char* region) {
    return *std::find_if(scene.material.begin(), scene.material.end(),
                         [&](const SceneMaterial& m) {
                           return m.region == region;
                         })
                ->puncture;
  };
  // As simulated: cutting forces of 0.5 and 0.25 N, membranes of 2 and 1 N.
  EXPECT_NEAR(of("layer1").toughness_j_per_m2, 1000.0, 40.0);
  EXPECT_NEAR(of("body").toughness_j_per_m2, 500.0, 40.0);
  EXPECT_NEAR(*of("layer1").friction_n_per_m, 20.0, 3.0);
  EXPECT_NEAR(*of("body").friction_n_per_m, 30.0, 3.0);
  EXPECT_NEAR(*of("layer1").membrane_n, 2.0, 0.1);
  EXPECT_NEAR(*of("body").membrane_n, 1.0, 0.1);
  EXPECT_NEAR(of("body").static_ratio, tissue_.static_ratio, 0.1);
  ASSERT_TRUE(scene.tool_needle[0]);
  EXPECT_EQ(scene.tool_needle[0]->edge_width_m, 0.0005);
  EXPECT_NEAR(scene.inclusion[0].under_m.value(), 6e-3, 3e-4);
  // What is not separated makes no scene.
  write("one.csv", {.deepest_m = {18e-3}, .extracts = false}, false);
  const ToolRun none =
      run({"one.csv"}, {"--edge-width-mm", "0.5", "--scene", folder_ / "none.toml"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("a scene needs the cutting force of layer 1"),
            std::string::npos)
      << none.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none.toml"));
}

TEST_F(InsertionTool, OneInsertionIsNotSeparated) {
  write("one.csv", {.deepest_m = {18e-3}, .extracts = false}, false);
  const auto json = parse_json(run({"one.csv"}, {"--json"}).out);
  EXPECT_TRUE(json.at("layers").at(0).at("cutting_n").at("value").is_null());
  EXPECT_NEAR(json.at("layers").at(0).at("slope_n_per_m").at("value"), 20.0, 3.0);
  EXPECT_TRUE(json.at("static_ratio").at("value").is_null());
  const ToolRun text = run({"one.csv"}, {"--edge-width-mm", "1.5"});
  EXPECT_NE(text.out.find("not separated"), std::string::npos);
}

TEST_F(InsertionTool, DepthIsTimeAtASpeed) {
  write("one.csv", {.deepest_m = {18e-3}, .extracts = false}, true);
  const auto by_depth = parse_json(run({"one.csv"}, {"--json"}).out);
  const ToolRun run_by_time =
      run({"one.csv"},
          {"--json", "--speed-mm-per-s", "1", "--time-column", "Time", "--time-unit",
           "s", "--force-column", "Force", "--force-unit", "N"});
  ASSERT_EQ(run_by_time.exit_code, 0) << run_by_time.err;
  const auto by_time = parse_json(run_by_time.out);
  for (const char* key : {"exponent", "contact_point_m"}) {
    const auto& expected = by_depth.at("curve").at(key);
    EXPECT_NEAR(by_time.at("curve").at(key).at("value"), expected.at("value"),
                1e-2 * expected.at("standard_deviation").get<double>())
        << key;
  }
}

TEST_F(InsertionTool, AFramesDeflectionIsTakenOffWhateverTheSign) {
  for (const double sign : {1.0, -1.0}) {
    SimulatedNeedle needle(tissue_);
    const Measurement m = simulate_insertion(needle, {.offset_n = 0.0}, 1);
    std::ofstream file(folder_ / "soft.csv");
    file << "Depth (mm),Force (N)\n";
    for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
      const double reported = m.depth_m[i] + m.force_n[i] / 20000.0;
      file << fmt::format("{},{}\n", sign * reported * 1e3, m.force_n[i]);
    }
    file.close();
    const ToolRun result =
        run({"soft.csv"}, {"--json", "--frame-stiffness-n-per-m", "20000"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto json = parse_json(result.out);
    EXPECT_NEAR(json.at("curve").at("exponent").at("value"), 1.5, 0.05) << sign;
  }
}

TEST_F(InsertionTool, AnswersWrongInputWithOneLine) {
  write("press.csv", {.deepest_m = {5e-3}}, true);
  struct Case {
    ToolRun result;
    std::string says;
  };
  const Case cases[] = {{run({"press.csv"}), "no puncture"},
                        {run({"both.csv"}, {"--cycle", "first"}), "--cycle"},
                        {run({"both.csv"}, {"--speed-mm-per-s", "1"}), "--time-column"},
                        {run({"both.csv"}, {"--speed-mm-per-s", "0"}), "speed"},
                        {run({"both.csv"}, {"--edge-width-mm", "-1"}), "edge"},
                        {run({"both.csv"}, {"--scene", "x.toml"}), "--edge-width-mm"},
                        {run({"missing.csv"}), "missing.csv"}};
  for (const Case& c : cases) {
    EXPECT_EQ(c.result.exit_code, 2) << c.says;
    EXPECT_EQ(c.result.out, "");
    EXPECT_NE(c.result.err.find(c.says), std::string::npos) << c.result.err;
    EXPECT_EQ(std::count(c.result.err.begin(), c.result.err.end(), '\n'), 1)
        << c.result.err;
  }
}

}  // namespace
}  // namespace palpate
