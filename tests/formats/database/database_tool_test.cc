// palpate-db as a user runs it.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/database/response_database.h"
#include "tests/support/contact_database.h"
#include "tests/support/punctured_sphere.h"
#include "tests/support/run_tool.h"
#include "tests/support/small_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

class DatabaseTool : public testing::Test {
 protected:
  DatabaseTool() { write_database(file_, small_database()); }

  const ScratchFolder folder_;
  const std::string file_ = folder_ / "a.h5";
};

TEST_F(DatabaseTool, InfoSaysWhatIsInside) {
  const ToolRun run = run_tool_process("palpate-db", {"info", file_, "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json report = parse_json(run.out);
  EXPECT_EQ(report.at("format_version"), 2);
  EXPECT_EQ(report.at("nodes"), 6);
  EXPECT_EQ(report.at("triangles"), 8);
  EXPECT_EQ(report.at("tools"), (Json{"tip", "ball"}));
  EXPECT_EQ(report.at("depth_max_m"), 0.005);
  EXPECT_EQ(report.at("bytes"), std::filesystem::file_size(file_));
  EXPECT_EQ(report.at("tool_details").at(1).at("responses"), 5);
  EXPECT_EQ(report.at("tool_details").at(1).at("falling"), 1);
  EXPECT_EQ(run_tool_process("palpate-db", {"info", file_}).exit_code, 0);
}

TEST_F(DatabaseTool, CheckPassesAGoodFileAndNamesWhatIsWrongWithAnother) {
  const ToolRun good = run_tool_process("palpate-db", {"check", file_});
  EXPECT_EQ(good.exit_code, 0);
  EXPECT_EQ(good.out, "ok: 6 nodes, 2 tools, 10 responses (2 falling)\n");
  std::filesystem::resize_file(file_, 3000);
  const ToolRun cut = run_tool_process("palpate-db", {"check", file_, "--json"});
  EXPECT_EQ(cut.exit_code, 3);
  EXPECT_FALSE(parse_json(cut.out).at("ok").get<bool>());
  EXPECT_NE(cut.err.find("is truncated or damaged (3000 bytes)"), std::string::npos)
      << cut.err;
  EXPECT_EQ(std::count(cut.err.begin(), cut.err.end(), '\n'), 1);
}

TEST_F(DatabaseTool, ANeedleIsDescribedAndDoubted) {
  ResponseDatabase database = small_database();
  database.tools[1].puncture = some_puncture(6);
  write_database(file_, database);
  const auto run = [&](const char* command) {
    return run_tool_process("palpate-db", {command, file_, "--json"});
  };
  const ToolRun sound = run("check");
  EXPECT_EQ(sound.err, "");
  EXPECT_TRUE(parse_json(sound.out).at("notes").empty());
  const Json details = parse_json(run("info").out).at("tool_details");
  EXPECT_TRUE(details.at(0).at("puncture").is_null());
  const Json& puncture = details.at(1).at("puncture");
  EXPECT_EQ(puncture.at("rule"), "force");
  EXPECT_EQ(puncture.at("materials").at(1).at("cutting_n"), 0.2);
  EXPECT_TRUE(puncture.at("materials").at(2).at("membrane_n").is_null());
  EXPECT_EQ(puncture.at("doubts"), "");
  database.tools[1].puncture.toughness_j_per_m2[0] = 25000.0;
  write_database(file_, database);
  const ToolRun doubted = run("check");
  EXPECT_EQ(doubted.exit_code, 0);
  EXPECT_NE(doubted.err.find("palpate-db: warning: tool ball: the toughness of skin"),
            std::string::npos)
      << doubted.err;
  EXPECT_EQ(parse_json(doubted.out).at("notes").size(), 1U);
}

TEST_F(DatabaseTool, NamesANeedleByItsOwnRadiusAndSaysHowDeepItWasCompared) {
  ResponseDatabase database = small_database();
  database.tools[1].puncture = known_puncture(6);
  database.tools[1].puncture.radius_m = 1e-6;
  write_database(file_, database);
  const Json info =
      parse_json(run_tool_process("palpate-db", {"info", file_, "--json"}).out);
  const Json& tool = info.at("tool_details").at(1);
  EXPECT_EQ(tool.at("description").get<std::string>().substr(0, 47),
            "needle of radius 0.001 mm, tip angle 30 deg, pr");
  EXPECT_EQ(tool.at("puncture").at("radius_m"), 1e-6);
  EXPECT_EQ(tool.at("puncture").at("materials").at(1).at("membrane_j"), 2e-3);
  EXPECT_TRUE(tool.at("puncture").at("materials").at(0).at("membrane_j").is_null());
  const ToolRun check = run_tool_process("palpate-db", {"check", file_});
  EXPECT_EQ(check.exit_code, 0);
  EXPECT_NE(check.err.find("warning: tool ball: its curve goes"), std::string::npos)
      << check.err;
}

TEST_F(DatabaseTool, PictureNeedsAToolWhereThereAreSeveral) {
  const std::string svg = folder_ / "a.svg";
  const ToolRun unnamed = run_tool_process("palpate-db", {"picture", file_, "-o", svg});
  EXPECT_EQ(unnamed.exit_code, 2);
  EXPECT_NE(unnamed.err.find("a tool must be named; there are: tip, ball"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(svg));
  EXPECT_EQ(
      run_tool_process("palpate-db", {"picture", file_, "-o", svg, "--tool", "ball"})
          .exit_code,
      0);
  EXPECT_TRUE(std::filesystem::exists(svg));
}

TEST_F(DatabaseTool, SliceMergeAndDiffComeBackToTheSameForces) {
  const std::string tip = folder_ / "tip.h5";
  const std::string ball = folder_ / "ball.h5";
  const std::string both = folder_ / "both.h5";
  const auto run = [](const std::vector<std::string>& arguments) {
    return run_tool_process("palpate-db", arguments);
  };
  EXPECT_EQ(run({"slice", file_, "-o", tip, "--tool", "tip"}).exit_code, 0);
  EXPECT_EQ(run({"slice", file_, "-o", ball, "--tool", "ball"}).exit_code, 0);
  EXPECT_EQ(run({"merge", tip, ball, "-o", both}).exit_code, 0);
  const ToolRun same = run({"diff", file_, both, "--json"});
  EXPECT_EQ(same.exit_code, 0) << same.err;
  EXPECT_TRUE(parse_json(same.out).at("agree").get<bool>());
  EXPECT_EQ(run({"slice", file_, "-o", both, "--precision", "int16"}).exit_code, 0);
  const ToolRun rounded = run({"diff", file_, both, "--json"});
  EXPECT_EQ(rounded.exit_code, 6);
  EXPECT_EQ(parse_json(rounded.out).at("tools").at(0).at("worst").size(), 5u);
  EXPECT_EQ(std::count(rounded.err.begin(), rounded.err.end(), '\n'), 1);
  EXPECT_EQ(run({"merge", tip, tip, "-o", both}).exit_code, 2);
}

TEST_F(DatabaseTool, ExportGoesByTheExtension) {
  for (const char* name : {"a.vtu", "a.csv", "a.json"}) {
    const ToolRun run = run_tool_process(
        "palpate-db", {"export", file_, "-o", folder_ / name, "--tool", "ball"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_GT(std::filesystem::file_size(folder_ / name), 500u);
  }
  const ToolRun unknown = run_tool_process(
      "palpate-db", {"export", file_, "-o", folder_ / "a.obj", "--tool", "ball"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("must be .vtu, .csv or .json"), std::string::npos);
}

TEST_F(DatabaseTool, AFlatFileSaysWhatItsHdf5FileSays) {
  const std::string flat = folder_ / "a.palpate";
  const std::string back = folder_ / "back.h5";
  const auto run = [](std::vector<std::string> words) {
    return run_tool_process("palpate-db", words);
  };
  const ToolRun exported = run({"export", file_, "--flat", flat, "--json"});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_EQ(parse_json(exported.out).at("bytes"), std::filesystem::file_size(flat));
  EXPECT_EQ(run({"check", flat}).out, run({"check", file_}).out);
  EXPECT_EQ(run({"diff", flat, file_}).exit_code, 0);
  EXPECT_EQ(run({"info", flat}).exit_code, 0);
  EXPECT_EQ(run({"report", flat, "-o", folder_ / "page.html"}).exit_code, 0);
  EXPECT_EQ(run({"export", flat, "--hdf5", back}).exit_code, 0);
  EXPECT_EQ(bytes_of(back), bytes_of(file_));
  EXPECT_EQ(run({"export", file_, "--flat", flat, "-o", "a.csv"}).exit_code, 2);
  EXPECT_EQ(run({"export", file_, "--flat", flat, "--hdf5", back}).exit_code, 2);
  EXPECT_EQ(run({"export", file_}).exit_code, 2);
}

TEST_F(DatabaseTool, ExportsTaxelsUnderThePressedTool) {
  write_database(file_, with_contacts());
  const std::string output = folder_ / "t.json";
  const auto exported = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"export", file_, "--tool", "tip", "-o", output});
    return run_tool_process("palpate-db", more);
  };
  const ToolRun run = exported({"--taxels", "60x50", "--pitch-m", "0.001", "--at",
                                "0.05,0,0", "--depth-m", "0.002"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json taxels = parse_json(bytes_of(output));
  double sum_n = 0.0;
  for (const Json& row : taxels.at("pressure_pa")) {
    ASSERT_EQ(row.size(), 60U);
    for (const double pressure_pa : row) {
      sum_n += 1e-6 * pressure_pa;
    }
  }
  EXPECT_GT(sum_n, 0.0);
  EXPECT_NEAR(sum_n + taxels.at("beside_n").get<double>(), taxels.at("force_n"), 1e-12);
}

TEST_F(DatabaseTool, RefusesTaxelsWithoutSense) {
  struct Case {
    std::vector<std::string> options;
    const char* says;
  };
  for (const Case& c : std::vector<Case>{
           {{"--taxels", "16", "--at", "0,0,0"}, "must be COLUMNSxROWS"},
           {{"--taxels", "16x16"}, "needs --at"},
           {{"--at", "0,0,0"}, "must be COLUMNSxROWS"},
           {{"--taxels", "4x0", "--at", "0,0,0"}, "must have 1 to 1000"},
           {{"--taxels", "4x4", "--at", "0,0,0", "--pressure-law"}, "exclude"},
           {{"--taxels", "4x4", "--at", "0,0,0", "--depth-m", "-1"},
            "must be positive"},
           {{"--taxels", "4x4", "--at", "0,0,0"}, "has no pressures"}}) {
    std::vector<std::string> options = c.options;
    options.insert(options.begin(),
                   {"export", file_, "--tool", "ball", "-o", folder_ / "t.csv"});
    const ToolRun run = run_tool_process("palpate-db", options);
    EXPECT_EQ(run.exit_code, 2) << c.says;
    EXPECT_NE(run.err.find(c.says), std::string::npos) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
}

TEST_F(DatabaseTool, BenchPrecisionListsEveryWayOfStoring) {
  const ToolRun run =
      run_tool_process("palpate-db", {"bench", "precision", file_, "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(parse_json(run.out).at("rows").size(), 6u);
}

TEST_F(DatabaseTool, AMissingFileAndAFolderAreTheUsersErrors) {
  EXPECT_EQ(run_tool_process("palpate-db", {"info", folder_ / "no.h5"}).exit_code, 2);
  EXPECT_EQ(run_tool_process("palpate-db", {"check", folder_.path()}).exit_code, 2);
  EXPECT_EQ(run_tool_process("palpate-db", {"info"}).exit_code, 2);
}

}  // namespace
}  // namespace palpate
