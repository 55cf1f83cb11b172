// From files as a lab has them to a body that can be felt: palpate-fit surface, and
// palpate-fit material, as a user runs them.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/database/response_database.h"
#include "formats/measurement/response_sweep.h"
#include "tests/support/run_tool.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr double kBodyRadius = 0.04;  // [m] of the body
constexpr double kToolRadius = 5e-3;  // [m]
constexpr int kRuns = 40;

double coefficient(const Eigen::Vector3d& p) {  // [N/m^1.5]
  return 3000.0 * std::exp(15.0 * p.z());
}

void write_obj(const std::filesystem::path& file, const SurfaceMesh& mesh) {
  std::ofstream out(file);
  for (Eigen::Index i = 0; i < mesh.position_m.rows(); ++i) {
    const auto p = mesh.position_m.row(i);
    out << fmt::format("v {} {} {}\n", 1e3 * p[0], 1e3 * p[1], 1e3 * p[2]);
  }
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    const auto f = mesh.triangle.row(t);
    out << fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
  }
}

void write_curve(const std::filesystem::path& file, double K, std::mt19937& generator) {
  std::normal_distribution<double> noise(0.0, 0.003);
  std::ofstream out(file);
  out << "Travel (mm),Load (N)\n";
  for (int i = 0; i < 120; ++i) {
    const double x_mm = 5.0 * i / 119.0;
    const double d = 1e-3 * std::max(0.0, x_mm - 1.0);
    out << fmt::format("{},{}\n", x_mm, K * std::pow(d, 1.5) + noise(generator));
  }
}

class FitSession : public testing::Test {
 protected:
  FitSession() {
    write_obj(folder_ / "body.obj", sphere_surface(kBodyRadius, 2));
    std::mt19937 generator(5);
    std::normal_distribution<double> normal;
    std::string text =
        "[read]\ndepth_column = \"Travel\"\ndepth_unit = \"mm\"\n"
        "force_column = \"Load\"\nforce_unit = \"N\"\n"
        "[indenter]\nshape = \"sphere\"\nradius_m = 0.005\n"
        "[body]\nmesh = \"body.obj\"\nlength_unit = \"mm\"\n";
    for (int i = 0; i < kRuns; ++i) {
      Eigen::Vector3d p(normal(generator), normal(generator), normal(generator));
      p = kBodyRadius * p.normalized();
      const std::string name = fmt::format("run{}.csv", i);
      write_curve(folder_ / name, (i == 9 ? 6.0 : 1.0) * coefficient(p), generator);
      text += fmt::format(
          "[[run]]\nfiles = \"{}\"\nposition_m = [{}, {}, {}]\n"
          "normal = [{}, {}, {}]\n",
          name, p.x(), p.y(), p.z(), p.x(), p.y(), p.z());
    }
    std::ofstream(folder_ / "run3.csv") << "no numbers here\n";
    std::ofstream(folder_ / "session.toml") << text;
  }

  ScratchFolder folder_;
};

TEST_F(FitSession, BecomesADatabaseOfTheWholeBody) {
  const std::string out = folder_ / "body.h5";
  const ToolRun result = run_tool_process(
      "palpate-fit", {"surface", folder_ / "session.toml", "-o", out, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = parse_json(result.out);
  EXPECT_EQ(json.at("probes"), kRuns - 2);
  ASSERT_EQ(json.at("left_out").size(), 2U);  // unreadable, and six times too stiff
  EXPECT_EQ(json.at("left_out")[0].at("run"), "run3.csv");
  EXPECT_EQ(json.at("left_out")[1].at("run"), "run9.csv");
  const auto& deepest = json.at("left_one_out").back();
  EXPECT_LT(2.0 * deepest.at("rms_log_force").get<double>(),
            deepest.at("nearest_rms_log_force").get<double>());

  const ResponseDatabase database = read_database(out);
  const ResponseTable& table = database.tools.at(0);
  EXPECT_EQ(table.tool.kind, "sphere");
  EXPECT_DOUBLE_EQ(table.tool.radius_m, kToolRadius);
  EXPECT_EQ(table.nodes(), 162);
  EXPECT_EQ(table.force_errors_n.size(), table.force_n.size());
  double squares = 0.0;
  for (Eigen::Index i = 0; i < database.body.position_m.rows(); ++i) {
    const CurveView curve = table.curve(i);
    const double truth = coefficient(database.body.position_m.row(i)) *
                         std::pow(curve.depth_m.back(), 1.5);
    squares += std::pow(std::log(curve.force_n.back() / truth), 2);
  }
  EXPECT_LT(std::sqrt(squares / 162.0), 0.06);
}

TEST_F(FitSession, TellsARunsFileOnceAndCountsAllRuns) {
  const ToolRun result = run_tool_process(
      "palpate-fit", {"surface", folder_ / "session.toml", "-o", folder_ / "body.h5"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("40 runs read: 38 behind the field, at 38 places; 2 left"),
            std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("left out run3.csv: no row with"), std::string::npos)
      << result.out;
}

TEST_F(FitSession, RefusesABodyInAnotherUnitAndTellsAHugeOne) {
  std::string text = bytes_of(folder_ / "session.toml");
  text.replace(text.find("length_unit = \"mm\""), 18, "length_unit = \"m\"");
  std::ofstream(folder_ / "metres.toml") << text;
  const ToolRun result = run_tool_process(
      "palpate-fit", {"surface", folder_ / "metres.toml", "-o", folder_ / "body.h5"});
  EXPECT_EQ(result.exit_code, 2) << result.out;
  EXPECT_NE(result.err.find("times 1000 they lie on it"), std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("length_unit of [body], now \"m\""), std::string::npos)
      << result.err;
}

TEST_F(FitSession, NeedsAToolThatCanBeRendered) {
  std::string text = bytes_of(folder_ / "session.toml");
  text.erase(text.find("[indenter]"), text.find("[body]") - text.find("[indenter]"));
  std::ofstream(folder_ / "bare.toml") << text;
  const ToolRun result = run_tool_process(
      "palpate-fit", {"surface", folder_ / "bare.toml", "-o", folder_ / "body.h5"});
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_NE(result.err.find("shape \"unknown\""), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "body.h5"));
}

TEST_F(FitSession, FindsTheMaterialInASweep) {
  ResponseSweep sweep{{{"body.youngs_modulus_pa", {1e4, 2e4, 4e4, 8e4}}}, {0}, {}, {}};
  for (int k = 1; k <= 8; ++k) {
    sweep.depth_m.push_back(4e-3 * k / 8.0);
  }
  for (const double E : sweep.parameter[0].value) {
    for (const double d : sweep.depth_m) {
      sweep.force_n.push_back(16.0 / 9.0 * E * std::sqrt(kToolRadius) *
                              std::pow(d, 1.5));
    }
  }
  write_sweep(folder_ / "sweep.csv", sweep);
  std::mt19937 generator(1);
  write_curve(folder_ / "one.csv", 16.0 / 9.0 * 3e4 * std::sqrt(kToolRadius),
              generator);
  std::ofstream(folder_ / "one.toml")
      << "[read]\ndepth_column = \"Travel\"\ndepth_unit = \"mm\"\n"
         "force_column = \"Load\"\nforce_unit = \"N\"\n[[run]]\nfiles = \"one.csv\"\n";
  const ToolRun result = run_tool_process(
      "palpate-fit",
      {"material", folder_ / "sweep.csv", folder_ / "one.toml", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto modulus = parse_json(result.out).at("parameters").at(0);
  EXPECT_TRUE(modulus.at("identifiable").get<bool>());
  EXPECT_NEAR(modulus.at("value").get<double>(), 3e4, 300.0);
}

}  // namespace
}  // namespace palpate
