// palpate-fit as a user runs it, with wrong input too.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/database/response_database.h"
#include "tests/support/run_tool.h"
#include "tests/support/staircase.h"
#include "tests/support/synthetic_curve.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class FitTool : public testing::Test {
 protected:
  FitTool() { write("curve.csv", synthetic({}, 1)); }

  void write(const std::string& name, const Measurement& m) const {
    std::ofstream file(folder_ / name);
    file << "Travel (mm),Load (N)\n";
    for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
      file << fmt::format("{},{}\n", m.depth_m[i] * 1e3, m.force_n[i]);
    }
  }

  ToolRun run(const std::vector<std::string>& more,
              const std::string& file = "curve.csv") const {
    std::vector<std::string> arguments = {"curve", folder_ / file};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_tool_process("palpate-fit", arguments);
  }

  std::vector<std::string> columns(const std::vector<std::string>& more,
                                   const std::string& depth = "Travel",
                                   const std::string& force_unit = "N") const {
    std::vector<std::string> all = {
        "--depth-column", depth,  "--depth-unit", "mm",
        "--force-column", "Load", "--force-unit", force_unit};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  ScratchFolder folder_;
};

TEST_F(FitTool, SaysWhatRelaxesOverSeveralHolds) {
  const Staircase stairs{{{8e-4, 240.0}, {5e-4, 420.0}, {5e-4, 720.0}}};
  std::ofstream(folder_ / "stairs.csv")
      << table_of(stairs.make(1), 1e3, 1.0, "Displacement (mm),Load (N),Time (s)\n");
  const ToolRun result = run({}, "stairs.csv");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_NE(result.out.find("Press and 3 holds together: 0.45"), std::string::npos)
      << result.out;
  const auto json = parse_json(run({"--json"}, "stairs.csv").out);
  const auto& joint = json.at("relaxation").at("press_and_hold");
  EXPECT_EQ(joint.at("holds_used"), 3);
  EXPECT_NEAR(joint.at("terms").at(1).at("tau_s"), Staircase::kTau[1], 3.0);
}

TEST_F(FitTool, ReportsEveryKeyForPrograms) {
  const ToolRun result =
      run(columns({"--json", "--tool", "sphere", "--radius-m", "0.03"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const auto json = parse_json(result.out);
  EXPECT_EQ(json.at("family"), "power_law");
  EXPECT_EQ(json.at("parameters").size(), 5U);
  EXPECT_NEAR(json.at("contact_point_m"), 2e-3, 1e-4);
  EXPECT_GT(json.at("contact_point_sd_m"), 0.0);
  EXPECT_NEAR(json.at("rms_n"), 0.005, 0.001);
  EXPECT_TRUE(json.at("flags").empty());
  EXPECT_GT(json.at("youngs_modulus_pa"), 0.0);
}

TEST_F(FitTool, TakesAFileByItsHeaderAndSaysWhatItTook) {
  const ToolRun alone = run({});
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  EXPECT_NE(alone.out.find("depth \"Travel (mm)\", force \"Load (N)\""),
            std::string::npos)
      << alone.out;
  const auto by_header = parse_json(run({"--json"}).out);
  const auto told = parse_json(run(columns({"--json"})).out);
  EXPECT_EQ(by_header.at("contact_point_m"), told.at("contact_point_m"));
}

TEST_F(FitTool, AsksWhichOfSeveralPressesIsMeant) {
  const Measurement m = synthetic({}, 1);
  std::ofstream file(folder_ / "two.csv");
  for (const double gain : {1.0, 2.0}) {
    file << "\"Results Table\"\n\"Time\",\"Extension\",\"Load\"\n"
            "\"(s)\",\"(mm)\",\"(kN)\"\n";
    for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
      file << fmt::format("{},{},{}\n", i, m.depth_m[i] * 1e3,
                          gain * m.force_n[i] * 1e-3);
    }
  }
  file.close();
  const ToolRun asks = run({}, "two.csv");
  EXPECT_EQ(asks.exit_code, 2);
  EXPECT_NE(asks.err.find("holds 2 presses: 1 (line 2), 2 ("), std::string::npos)
      << asks.err;
  const auto stiffness = [&](const char* press) {
    const ToolRun result = run({"--press", press, "--json"}, "two.csv");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return parse_json(result.out).at("mean_stiffness_n_per_m").get<double>();
  };
  EXPECT_NEAR(stiffness("2"), 2.0 * stiffness("1"), 0.02 * stiffness("1"));
  EXPECT_EQ(run({"--press", "3"}, "two.csv").exit_code, 2);
  EXPECT_EQ(run({"--press", "1"}).exit_code, 0);
  EXPECT_EQ(run({"--press", "2"}).exit_code, 2);  // curve.csv holds one
}

TEST_F(FitTool, AsksWhichOfPressesInOneTableIsMeant) {
  const Measurement m = synthetic({}, 1);
  std::ofstream file(folder_ / "loops.csv");
  file << "Travel (mm),Load (N)\n";
  for (const double gain : {1.0, 2.0}) {
    for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
      file << fmt::format("{},{}\n", m.depth_m[i] * 1e3, gain * m.force_n[i]);
    }
    file << "2.0,0\n0.5,0\n";
  }
  file.close();
  const ToolRun asks = run({}, "loops.csv");
  EXPECT_EQ(asks.exit_code, 2);
  EXPECT_NE(asks.err.find("holds 2 presses one after another"), std::string::npos)
      << asks.err;
  EXPECT_EQ(run({"--press", "2"}, "loops.csv").exit_code, 0);
  EXPECT_EQ(run({"--cycle", "first"}, "loops.csv").exit_code, 0);
}

TEST_F(FitTool, TakesTheTipOfTheFileAndSaysSo) {
  const Measurement m = synthetic({}, 1);
  std::ofstream file(folder_ / "tip.txt");
  file << "Tip radius (um)\t30000\n"
          "Time (s)\tLoad (uN)\tIndentation (nm)\tCantilever (nm)\tPiezo (nm)\n";
  for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
    file << fmt::format("{}\t{}\t0\t5\t{}\n", i, m.force_n[i] * 1e6,
                        m.depth_m[i] * 1e9 + 5.0);
  }
  file.close();
  const ToolRun alone = run({"--json"}, "tip.txt");
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  const auto json = parse_json(alone.out);
  EXPECT_NE(json.at("tip").get<std::string>().find("as the file states"),
            std::string::npos);
  const auto modulus = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = {"--json", "--tool", "sphere"};
    all.insert(all.end(), more.begin(), more.end());
    return parse_json(run(all, "tip.txt").out).at("youngs_modulus_pa");
  };
  EXPECT_EQ(json.at("youngs_modulus_pa"), modulus({}));
  EXPECT_EQ(json.at("youngs_modulus_pa"), modulus({"--radius-m", "0.03"}));
  EXPECT_NE(json.at("youngs_modulus_pa"), modulus({"--radius-m", "0.02"}));
}

TEST_F(FitTool, ClaimsNoModulusWithoutATool) {
  const auto json = parse_json(run(columns({"--json"})).out);
  EXPECT_TRUE(json.at("youngs_modulus_pa").is_null());
  EXPECT_NE(json.at("youngs_modulus_refused"), "");
}

// Force of the tool's own exponent that reaches 1 N at 5 mm: E in closed form, with
// E* = E / (1 - nu^2) = 4 / 3 E.
TEST_F(FitTool, TakesTheSphereThePunchTheConeAndThePlate) {
  const auto modulus_pa = [&](double exponent, std::vector<std::string> tool) {
    write("own.csv", synthetic({.exponent = exponent, .noise_n = 1e-4}, 1));
    tool.insert(tool.begin(), "--json");
    const ToolRun result = run(columns(tool), "own.csv");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const auto json = parse_json(result.out);
    EXPECT_EQ(json.at("youngs_modulus_refused"), "");
    return json.at("youngs_modulus_pa").get<double>();
  };
  const double d = 5e-3, tangent = std::tan(40.0 * std::numbers::pi / 180.0);
  const auto expect = [](double found, double exact) {
    EXPECT_NEAR(found, exact, 1e-3 * exact);  // noise of 1e-4 of the force
  };
  const double sphere = modulus_pa(1.5, {"--tool", "sphere", "--radius-m", "0.03"});
  expect(sphere, 0.75 * 0.75 / (std::sqrt(0.03) * std::pow(d, 1.5)));
  expect(modulus_pa(1.0, {"--tool", "flat-punch", "--radius-m", "0.004"}),
         0.75 / (2.0 * 0.004 * d));
  expect(modulus_pa(2.0, {"--tool", "cone", "--half-angle-deg", "40"}),
         0.75 * 0.5 * std::numbers::pi / (tangent * d * d));
  expect(
      modulus_pa(1.0, {"--tool", "plate", "--radius-m", "0.01", "--height-m", "0.08"}),
      0.08 / (std::numbers::pi * 1e-4 * d));
  EXPECT_LT(modulus_pa(1.5, {"--tool", "sphere", "--radius-m", "0.03", "--thickness-m",
                             "0.03"}),
            0.9 * sphere);  // the base carries a part of the force
  const std::string out = folder_ / "cone.h5";
  const ToolRun made =
      run(columns({"-o", out, "--tool", "cone", "--half-angle-deg", "40"}));
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(read_database(out).tools.at(0).tool.kind, "cone");
}

TEST_F(FitTool, WritesADatabaseThatReadsBack) {
  const std::string out = folder_ / "out.h5";
  const ToolRun result =
      run(columns({"-o", out, "--tool", "sphere", "--radius-m", "0.03"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("contact_point"), std::string::npos);
  EXPECT_EQ(read_database(out).measurement.depth_m.size(), 350U);
}

TEST_F(FitTool, AnswersBadInputWithOneLineAndLeavesNoFile) {
  const std::string out = folder_ / "out.h5";
  const std::vector<std::string> ball = {"-o", out, "--tool", "sphere", "--radius-m"};
  const auto with_radius = [&](const std::string& radius) {
    std::vector<std::string> all = ball;
    all.push_back(radius);
    return all;
  };
  std::ofstream(folder_ / "short.csv") << "Travel,Load\n0,0\n1,1\n2,4\n";
  std::ofstream(folder_ / "words.csv") << "nothing here\n";
  struct Case {
    ToolRun result;
    std::string says;
  };
  const Case cases[] = {
      {run(columns(with_radius("0.01")), "absent.csv"), "no such file"},
      {run(columns(with_radius("0.01"), "Travell")), "\"Travel (mm)\", \"Load (N)\""},
      {run(columns(with_radius("0.01"), "Travel", "stone")), "unknown force unit"},
      {run(columns(with_radius("0.01"), "Travel", "gf")), "states the unit N"},
      {run(columns(with_radius("-0.01"))), "--radius-m is -0.01"},
      {run(columns(with_radius("0.01")), "short.csv"), "at least 8"},
      {run(columns(with_radius("0.01")), "words.csv"), "no row"},
      {run(columns({"-o", out})), "--tool sphere"},
      {run(columns({"--tool", "brick"})), "available: sphere, flat-punch, cone, plate"},
      {run(columns({"--tool", "cone", "--radius-m", "1"})),
       "--radius-m does not belong to --tool cone"},
      {run(columns({"--tool", "cone"})), "--half-angle-deg"},
      {run(columns({"--tool", "cone", "--half-angle-deg", "95"})), "(0, 90)"},
      {run(columns({"--tool", "plate", "--radius-m", "0.01"})), "--height-m"},
      {run(columns({"--height-m", "0.01"})), "--tool plate"},
      {run(columns(
           {"-o", out, "--tool", "plate", "--radius-m", "0.01", "--height-m", "0.01"})),
       "a plate on a cylinder is none"},
      {run(columns({"--tool", "sphere"})), "--radius-m"},
      {run(columns({"--from-m", "0.003", "--to-m", "0.002"})), "is empty"}};
  for (const Case& c : cases) {
    EXPECT_EQ(c.result.exit_code, 2) << c.result.err;
    EXPECT_NE(c.result.err.find(c.says), std::string::npos) << c.result.err;
    EXPECT_EQ(std::count(c.result.err.begin(), c.result.err.end(), '\n'), 1)
        << c.result.err;
    EXPECT_EQ(c.result.out, "");
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(FitBatch, FailsWhereNoRunCanBeRead) {
  const ScratchFolder folder;
  std::ofstream(folder / "odd.csv") << "Travel (mm),Load (N)\nno,number\n";
  std::ofstream(folder / "session.toml") << R"([read]
depth_column = "Travel"
depth_unit = "mm"
force_column = "Load"
force_unit = "N"
[indenter]
shape = "sphere"
radius_m = 0.01
[[run]]
files = "odd.csv"
)";
  const ToolRun result =
      run_tool_process("palpate-fit", {"batch", (folder / "session.toml").string(),
                                       "-o", (folder / "out").string(), "--quiet"});
  EXPECT_EQ(result.exit_code, 2) << result.out;
  EXPECT_NE(result.err.find("no run could be read or fitted"), std::string::npos)
      << result.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "out/results.csv"));
}

}  // namespace
}  // namespace palpate
