// palpate-fit lateral as a user runs it, with files as strangers write them.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/scene/scene.h"
#include "tests/fitting/lateral/loop_simulation.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class LateralTool : public testing::Test {
 protected:
  using Row = std::function<std::string(std::size_t, const LateralRun&)>;

  // k = 2000 N/m, mu = 0.5, 1 N, 2.5 cycles of 1 mm.
  static LateralRun loop(const SimulatedMotion& motion = kMotion) {
    return simulate_loop({}, motion, 3).run;
  }
  void write(const std::string& name, const LateralRun& run, const std::string& header,
             const Row& row) const {
    std::ofstream file(folder_ / name);
    file << header;
    for (std::size_t i = 0; i < run.force_n.size(); ++i) {
      file << row(i, run) << "\n";
    }
  }
  static std::string plain_row(std::size_t i, const LateralRun& run) {
    return fmt::format("{},{},{}", run.displacement_m[i] * 1e3, run.force_n[i],
                       run.normal_n[i]);
  }
  void write_plain(const std::string& name, const LateralRun& run) const {
    write(name, run, "x (mm),Fx (N),Fz (N)\n", plain_row);
  }
  ToolRun run(const std::vector<std::string>& files,
              const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"lateral"};
    for (const std::string& file : files) {
      arguments.push_back(folder_ / file);
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_tool_process("palpate-fit", arguments);
  }
  nlohmann::json json_of(const std::string& file,
                         std::vector<std::string> more = {}) const {
    more.emplace_back("--json");
    const ToolRun result = run({file}, more);
    EXPECT_EQ(result.exit_code, 0) << file << ": " << result.err;
    return result.exit_code == 0 ? parse_json(result.out) : nlohmann::json();
  }
  static void expect_truth(const nlohmann::json& json, const std::string& what) {
    ASSERT_TRUE(json.contains("runs")) << what;
    EXPECT_NEAR(json.at("runs").at(0).at("stiffness_n_per_m").at("value"), 2000.0, 40.0)
        << what;
    EXPECT_NEAR(json.at("friction").at("value"), 0.5, 0.01) << what;
  }

  static constexpr SimulatedMotion kMotion{.cycles = 2.5, .noise_n = 0.005};
  ScratchFolder folder_;
};

TEST_F(LateralTool, PrintsEveryPartWithItsInterval) {
  write_plain("loop.csv", loop());
  const ToolRun result = run({"loop.csv"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (const char* part : {"sharp slip", "friction mu", "presliding length",
                           "stiffness k", "sliding force", "loss a cycle",
                           "loss by the law", "drift", "normal force \"Fz (N)\""}) {
    EXPECT_NE(result.out.find(part), std::string::npos) << part << "\n" << result.out;
  }
  EXPECT_EQ(result.out.find("none:"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("warning"), std::string::npos) << result.out;
}

TEST_F(LateralTool, ReadsFilesAsStrangersWriteThem) {
  const auto micro = [](const char* mark, std::size_t i, const LateralRun& run) {
    return fmt::format("{:.4f}{}{:.4f}{}{:.4f}", run.displacement_m[i] * 1e6, mark,
                       run.force_n[i] * 1e3, mark, run.normal_n[i] * 1e3);
  };
  const auto comma = [](std::string text) {
    std::replace(text.begin(), text.end(), '.', ',');
    return text;
  };
  write("brackets.csv", loop(), "Stroke [um],Friction force [mN],Normal load [mN]\n",
        [&](auto i, const auto& r) {
          return micro(",", i, r);
        });
  write("underscores.tsv", loop(), "pos_um\tF_T_mN\tF_N_mN\n",
        [&](auto i, const auto& r) {
          return micro("\t", i, r);
        });
  write("german.csv", loop(), "Weg [um];Reibkraft Ft [mN];Fn [mN]\n",
        [&](auto i, const auto& r) {
          return comma(micro(";", i, r));
        });
  write("comments.csv", loop(),
        "# rig 3, ball 6 mm\n\n# sample: skin\nx (mm),Fx (N),Fz (N)\n",
        [](auto i, const auto& r) {
          return (i % 100 == 50 ? "# pause\n\n" : "") + plain_row(i, r);
        });
  write("repeated.csv", loop(), "", [](auto i, const auto& r) {
    return (i % 250 == 0 ? "x (mm),Fx (N),Fz (N)\n" : "") + plain_row(i, r);
  });
  write("stamps.csv", loop(), "Timestamp,Time (s),x (mm),Fx (N),Fz (N)\n",
        [](auto i, const auto& r) {
          return fmt::format("2024-05-01 12:00:{:02}.{:03},{},{}", i / 100 % 60,
                             i % 100 * 10, r.time_s[i], plain_row(i, r));
        });
  write("clock.csv", loop(), "Time (s),x (mm),Fx (N),Fz (N)\n",
        [](auto i, const auto& r) {
          return fmt::format("12:00:{:02},{}", i / 100 % 60, plain_row(i, r));
        });
  write("signs.csv", loop(), "x (mm),Fx (N),Fz (N)\n", [](auto i, const auto& r) {
    return fmt::format("{},{},{}", 50.0 - r.displacement_m[i] * 1e3, r.force_n[i],
                       -r.normal_n[i]);
  });
  write("nan.csv", loop(), "x (mm),Fx (N),Fz (N)\n", [](auto i, const auto& r) {
    return i % 97 == 5 ? std::string(i % 2 == 0 ? "nan,nan,nan" : "0.1,NaN,1.0")
                       : plain_row(i, r);
  });
  write("units.csv", loop(), "Position,Tangential,Normal\nmm,N,N\n", plain_row);
  write("quotes.csv", loop(), "\"x, lateral (mm)\",\"Fx (N)\",\"Fz (N)\"\r\n",
        [](auto i, const auto& r) {
          return plain_row(i, r) + "\r";
        });
  for (const char* file :
       {"brackets.csv", "underscores.tsv", "german.csv", "comments.csv", "repeated.csv",
        "stamps.csv", "clock.csv", "signs.csv", "nan.csv", "units.csv", "quotes.csv"}) {
    expect_truth(json_of(file), file);
  }
}

TEST_F(LateralTool, ReadsHalfLoopsRampsAndNumbersAlone) {
  write_plain("half.csv", loop({.cycles = 0.25, .noise_n = 0.005}));
  expect_truth(json_of("half.csv"), "half");
  write("bare.txt", loop(), "", [](auto i, const auto& r) {
    return fmt::format("{} {}", r.displacement_m[i] * 1e3, r.force_n[i]);
  });
  expect_truth(json_of("bare.txt", {"--displacement-column", "1", "--displacement-unit",
                                    "mm", "--force-column", "2", "--force-unit", "N",
                                    "--normal-force-n", "1"}),
               "bare");
}

TEST_F(LateralTool, TablesWithADepthEachAreRuns) {
  const LateralRun soft =
      simulate_loop({.stiffness_n_per_m = 1500.0, .normal_n = 0.5}, kMotion, 3).run;
  write_plain("a.csv", soft);
  write_plain("b.csv", loop());
  const ToolRun result = run({"a.csv", "b.csv"}, {"--depth-mm", "1,2", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = parse_json(result.out);
  ASSERT_EQ(json.at("runs").size(), 2U);
  EXPECT_DOUBLE_EQ(json.at("runs").at(1).at("depth_m"), 2e-3);
  EXPECT_NEAR(json.at("runs").at(0).at("stiffness_n_per_m").at("value"), 1500.0, 40.0);
  EXPECT_NEAR(json.at("friction").at("value"), 0.5, 0.01);
  EXPECT_EQ(json.at("laws").at(0).at("stiffness_n_per_m").size(), 2U);
}

// Its file, with what a measurement does not tell, is a scene.
TEST_F(LateralTool, WritesTheKeysOfAScene) {
  write_plain("loop.csv", loop());
  ASSERT_EQ(run({"loop.csv"}, {"--scene", folder_ / "part.toml"}).exit_code, 0);
  std::ofstream(folder_ / "scene.toml")
      << "[body]\nmesh = \"body.obj\"\nlength_unit = \"m\"\n[[material]]\nregion = "
         "\"body\"\nlaw = \"linear\"\nyoungs_modulus_pa = 15000.0\npoissons_ratio = "
         "0.45\n[[support]]\nbox_m = [[-1, -1, -1], [1, 1, -0.02]]\n[reach]\n"
         "depth_max_m = 0.004\n"
      << bytes_of(folder_ / "part.toml")
      << "name = \"ball\"\nshape = \"sphere\"\nradius_m = 0.005\n";
  const Scene scene = read_scene(folder_ / "scene.toml");
  EXPECT_NEAR(scene.tool[0].friction, 0.5, 0.01);
  EXPECT_NEAR(scene.tool[0].presliding_m, 0.25e-3, 0.01e-3);
  // What is not known makes no scene.
  const ToolRun none =
      run({"loop.csv"}, {"--force-column", "Fx", "--displacement-column", "x",
                         "--scene", folder_ / "none.toml"});
  EXPECT_EQ(none.exit_code, 0) << none.err;
  write("alone.csv", loop(), "x (mm),Fx (N)\n", [](auto i, const auto& r) {
    return fmt::format("{},{}", r.displacement_m[i] * 1e3, r.force_n[i]);
  });
  const ToolRun refused = run({"alone.csv"}, {"--scene", folder_ / "no.toml"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("a scene needs the friction coefficient"),
            std::string::npos)
      << refused.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "no.toml"));
}

TEST_F(LateralTool, AnInstrumentsDeflectionIsTakenOff) {
  write_plain("soft.csv",
              simulate_loop({.instrument_n_per_m = 6000.0}, kMotion, 3).run);
  expect_truth(json_of("soft.csv", {"--frame-stiffness-n-per-m", "6000"}), "soft");
}

TEST_F(LateralTool, AnswersWrongInputWithOneLine) {
  write_plain("loop.csv", loop());
  write("still.csv", loop(), "x (mm),Fx (N)\n", [](auto, const auto&) {
    return std::string("1,2");
  });
  write("several.csv", loop(), "x (mm),Fx (N),Ft (N)\n", plain_row);
  write("nounit.csv", loop(), "x,Fx,Fz\n", plain_row);
  write("normal.csv", loop(), "x (mm),Fz (N)\n", [](auto i, const auto& r) {
    return fmt::format("{},{}", r.displacement_m[i] * 1e3, r.force_n[i]);
  });
  struct Case {
    ToolRun result;
    std::string says;
  };
  const Case cases[] = {
      {run({"missing.csv"}), "missing.csv"},
      {run({"still.csv"}), "does not move sideways"},
      {run({"several.csv"}), "2 columns may be the tangential force"},
      {run({"nounit.csv"}), "states a unit of length"},
      {run({"normal.csv"}), "tell which is the tangential force"},
      {run({"loop.csv"}, {"--cycle", "first"}), "--cycle"},
      {run({"loop.csv"}, {"--normal-force-n", "-1"}), "normal force is -1 N"},
      {run({"loop.csv"}, {"--normal-force-n", "1,2"}), "1 or one for each of 1 runs"},
      {run({"loop.csv"}, {"--normal-force-n", "1", "--normal-force-column", "Fz"}),
       "tell one of them"},
      {run({"loop.csv"}, {"--normal-force-column", "Fq"}), "no normal force column"},
      {run({"loop.csv"}, {"--normal-force-unit", "N"}), "goes with"},
      {run({"loop.csv"}, {"--frame-stiffness-n-per-m", "-5"}), "stiffness"}};
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
