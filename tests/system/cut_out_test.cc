// A build on parts that are cut out of the body: it says so, keeps near the build of
// the whole body, and gives the same bytes however it is shared out.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/database/response_database.h"
#include "tests/support/organ_scene.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFingertipScene = R"([[tool]]
name = "fingertip"
shape = "sphere"
radius_m = 0.02
[reach]
box_m = [[-0.03, -1.0, 0.043], [1.0, 1.0, 1.0]]
depth_max_m = 0.001
[accuracy]
force_relative = 0.3
contact_resolution = 1.0
depths = 4
)";
constexpr const char* kCutOut = R"(verify = 1
[cutout]
radius_m = 0.026
)";
constexpr const char* kWhole = R"(verify = 0
refine = "global"
)";

class CutOutBuild : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<ScratchFolder>();
    std::ofstream(path("parts.toml"))
        << organ_on_table("linear") << kFingertipScene << kCutOut;
    std::ofstream(path("whole.toml"))
        << organ_on_table("linear") << kFingertipScene << kWhole;
    const ToolRun body =
        run_tool_process("palpate-precompute",
                         {"body", "organ", "--levels", "2", "-o", path("organ.obj")});
    ASSERT_EQ(body.exit_code, 0) << body.err;
    parts_ = build("parts.toml", {"-o", path("parts.h5"), "--json"});
    ASSERT_EQ(parts_.exit_code, 0) << parts_.err;
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::string path(const std::string& name) {
    return (*folder_ / name).string();
  }
  static ToolRun build(const std::string& scene, const std::vector<std::string>& more) {
    std::vector<std::string> all{"build", path(scene)};
    all.insert(all.end(), more.begin(), more.end());
    return run_tool_process("palpate-precompute", all);
  }
  static std::unique_ptr<ScratchFolder> folder_;
  static ToolRun parts_;
};
std::unique_ptr<ScratchFolder> CutOutBuild::folder_;
ToolRun CutOutBuild::parts_;

TEST_F(CutOutBuild, IsNearTheBuildOfTheWholeBody) {
  const ToolRun whole = build("whole.toml", {"-o", path("whole.h5")});
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  const ResponseTable cut = read_database(path("parts.h5")).tools.at(0);
  const ResponseTable all = read_database(path("whole.h5")).tools.at(0);
  ASSERT_EQ(cut.sample_begin, all.sample_begin);
  ASSERT_GT(cut.force_n.size(), 10u);
  double worst = 0.0;
  double sum = 0.0;
  double estimated = 0.0;
  int nodes = 0;
  for (std::size_t i = 0; i + 1 < cut.sample_begin.size(); ++i) {
    const auto last = static_cast<std::size_t>(cut.sample_begin[i + 1]);
    if (cut.sample_begin[i + 1] > cut.sample_begin[i]) {
      const double off = std::abs(cut.force_n[last - 1] / all.force_n[last - 1] - 1.0);
      worst = std::max(worst, off);
      sum += off;
      estimated += std::sqrt(std::max(0.0, std::pow(cut.error_relative[i], 2) -
                                               std::pow(all.error_relative[i], 2)));
      ++nodes;
    }
  }
  RecordProperty("worst", std::to_string(worst));
  RecordProperty("mean", std::to_string(sum / nodes));
  RecordProperty("estimated_mean", std::to_string(estimated / nodes));
  std::printf("off by %.4f at most, %.4f in the mean, estimated %.4f\n", worst,
              sum / nodes, estimated / nodes);
  // A coarse body with two or three edges across its height.
  EXPECT_LT(worst, 0.08);
  EXPECT_LT(sum, estimated);
}

TEST_F(CutOutBuild, SaysWhatItLeftOut) {
  const std::string left_out = read_database(path("parts.h5")).provenance.left_out;
  EXPECT_NE(left_out.find("farther than 0.026 m from a node, in whose place stands a "
                          "coarse body with edges of 0.013 m"),
            std::string::npos)
      << left_out;
  const auto report = parse_json(parts_.out);
  EXPECT_EQ(report.at("checked").size(), 1u);
}

TEST_F(CutOutBuild, ShardsAndWorkersDoNotChangeTheBytes) {
  for (const char* shard : {"0", "1"}) {
    const ToolRun part =
        build("parts.toml", {"-o", path(std::string("part") + shard), "--threads", "1",
                             "--shard", std::string(shard) + "/2"});
    ASSERT_EQ(part.exit_code, 0) << part.err;
  }
  const ToolRun merge = run_tool_process(
      "palpate-db", {"merge", path("part1"), path("part0"), "-o", path("merged.h5")});
  ASSERT_EQ(merge.exit_code, 0) << merge.err;
  EXPECT_TRUE(bytes_of(path("merged.h5")) == bytes_of(path("parts.h5")));
}

TEST_F(CutOutBuild, IndentRefusesIt) {
  const ToolRun run = run_tool_process(
      "palpate-precompute", {"indent", path("parts.toml"), "--at", "0,0,0.04"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("indent presses the whole body: the scene has [cutout]"),
            std::string::npos)
      << run.err;
}

}  // namespace
}  // namespace palpate
