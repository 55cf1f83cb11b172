// A build cut short, shared out or done by more threads gives the same bytes.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>

#include <gtest/gtest.h>

#include "formats/base/sha256.h"
#include "formats/database/work_unit.h"
#include "tests/support/organ_scene.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

// One cluster, and checks.
constexpr const char* kUnitsScene = R"([[tool]]
name = "fingertip"
shape = "sphere"
radius_m = 0.03
[reach]
box_m = [[-1.0, -1.0, 0.041], [1.0, 1.0, 1.0]]
depth_max_m = 0.005
[accuracy]
force_relative = 0.3
contact_resolution = 1.0
depths = 4
verify = )";

// Two laws, because what is shared out does not depend on it, and a linear build is
// short: that has four units, the other two.
constexpr const char* kLinear = "linear";
constexpr const char* kNonlinear = "neo-hookean";

// An undisturbed build of each, by every core.
class BuildUnits : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<ScratchFolder>();
    const ToolRun body =
        run_tool_process("palpate-precompute",
                         {"body", "organ", "--levels", "2", "-o", path("organ.obj")});
    ASSERT_EQ(body.exit_code, 0) << body.err;
    for (const std::string law : {kLinear, kNonlinear}) {
      std::ofstream(path(law + ".toml"))
          << organ_on_table(law) << kUnitsScene << (law == kLinear ? "3\n" : "1\n");
      const ToolRun whole = build(law + ".h5", {}, law);
      ASSERT_EQ(whole.exit_code, 0) << whole.err;
    }
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::string path(const std::string& name) {
    return (*folder_ / name).string();
  }
  static std::vector<std::string> arguments(const std::string& output,
                                            const std::vector<std::string>& more,
                                            const std::string& law = kLinear) {
    std::vector<std::string> all{"build", path(law + ".toml"), "-o", path(output)};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  static ToolRun build(const std::string& output,
                       const std::vector<std::string>& more = {},
                       const std::string& law = kLinear) {
    return run_tool_process("palpate-precompute", arguments(output, more, law));
  }
  // Units that a build has kept so far.
  static std::int64_t kept(const std::string& output) {
    std::error_code ignored;
    const fs::directory_iterator entries(path(output) + ".partial", ignored);
    return std::count_if(begin(entries), end(entries),
                         [](const fs::directory_entry& e) {
                           const std::string name = e.path().filename().string();
                           return name.starts_with("unit-") && name.size() == 11;
                         });
  }
  static void expect_whole(const std::string& output,
                           const std::string& law = kLinear) {
    EXPECT_TRUE(bytes_of(path(output)) == bytes_of(path(law + ".h5"))) << output;
    EXPECT_FALSE(fs::exists(path(output) + ".partial"));
  }
  static std::unique_ptr<ScratchFolder> folder_;
};
std::unique_ptr<ScratchFolder> BuildUnits::folder_;

TEST_F(BuildUnits, OneWorkerWithoutVectorsGivesTheSameBytes) {
  setenv("PALPATE_INSTRUCTIONS", "baseline", 1);
  // The C library's functions choose by the processor, too.
  setenv("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-FMA,-AVX2,-AVX512F", 1);
  const ToolRun tool = build("baseline.h5", {"--threads", "1"}, kNonlinear);
  unsetenv("PALPATE_INSTRUCTIONS");
  unsetenv("GLIBC_TUNABLES");
  ASSERT_EQ(tool.exit_code, 0) << tool.err;
  expect_whole("baseline.h5", kNonlinear);
}

TEST_F(BuildUnits, ThreeShardsMergedGiveTheSameBytes) {
  for (const char* shard : {"0", "1", "2"}) {
    const ToolRun part =
        build(std::string("part") + shard, {"--shard", std::string(shard) + "/3"});
    ASSERT_EQ(part.exit_code, 0) << part.err;
  }
  const ToolRun merge = run_tool_process(
      "palpate-db",
      {"merge", path("part2"), path("part0"), path("part1"), "-o", path("merged.h5")});
  ASSERT_EQ(merge.exit_code, 0) << merge.err;
  expect_whole("merged.h5");
  const ToolRun partly = run_tool_process(
      "palpate-db", {"merge", path("part0"), path("part2"), "-o", path("partly.h5")});
  EXPECT_EQ(partly.exit_code, 2);
  EXPECT_NE(partly.err.find("1 of 4 units are missing: 1"), std::string::npos)
      << partly.err;
}

TEST_F(BuildUnits, SubmittedToThisMachineGivesTheSameBytes) {
  const ToolRun run = run_tool_process(
      "palpate-precompute",
      {"submit", path("linear.toml"), "-o", path("submitted.h5"), "--engine", "local",
       "--nodes", "2", "--threads", "1", "--run"});
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  expect_whole("submitted.h5");
}

TEST_F(BuildUnits, KilledAgainAndAgainAndResumedGivesTheSameBytes) {
  int killed = 0;
  // Not after the last of the four: the file comes at once.
  for (const std::int64_t units : {0, 1, 2, 3}) {
    const ToolRun run =
        kill_tool_process("palpate-precompute",
                          arguments("killed.h5", {"--resume", "--threads", "1"}), [&] {
                            return fs::exists(path("killed.h5.partial/digest")) &&
                                   kept("killed.h5") >= units;
                          });
    killed += run.exit_code == 128 + 9 ? 1 : 0;
    EXPECT_FALSE(fs::exists(path("killed.h5")));
    if (units == 1) {
      const ToolRun refused = build("killed.h5");
      EXPECT_EQ(refused.exit_code, 2);
      EXPECT_NE(refused.err.find("--resume"), std::string::npos) << refused.err;
    }
  }
  EXPECT_EQ(killed, 4);
  const ToolRun resumed = build("killed.h5", {"--resume"});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  expect_whole("killed.h5");
}

// A kept unit whose first node has failed, as if its press had.
void fail_first_node(const fs::path& unit) {
  constexpr std::size_t kDigest = 64;
  const std::string kept = bytes_of(unit);
  WorkUnitOutcome outcome =
      unit_from_bytes(std::as_bytes(std::span(kept)).subspan(kDigest), unit.string());
  ASSERT_FALSE(outcome.is_check);
  outcome.node.front().response = {};
  outcome.node.front().failure = "the needle broke";
  fail_if_broken(outcome.node.front());
  const std::vector<std::byte> body = to_bytes(outcome);
  Sha256 sum;
  sum.update(body);
  std::ofstream out(unit, std::ios::binary);
  out << sum.hex();
  out.write(reinterpret_cast<const char*>(body.data()),
            static_cast<std::streamsize>(body.size()));
}

TEST_F(BuildUnits, AFailedNodeIsAWarningAndAFailureOnlyIfThatIsAsked) {
  for (const bool strict : {false, true}) {
    const std::string output = strict ? "strict.h5" : "warned.h5";
    const fs::path unit = path(output) + ".partial/unit-000000";
    (void)kill_tool_process("palpate-precompute", arguments(output, {}), [&] {
      return fs::exists(unit);
    });
    if (!fs::exists(unit)) {
      GTEST_SKIP() << "the build ended before it could be killed";
    }
    fail_first_node(unit);
    std::vector<std::string> flags{"--resume"};
    if (strict) {
      flags.emplace_back("--strict");
    }
    const ToolRun run = build(output, flags);
    EXPECT_EQ(run.exit_code, strict ? 4 : 0) << run.err;
    EXPECT_NE(run.err.find("warning: of "), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("1 have no response"), std::string::npos) << run.err;
    EXPECT_NE(run.out.find("the needle broke"), std::string::npos) << run.out;
    const ToolRun check = run_tool_process("palpate-db", {"check", path(output)});
    EXPECT_EQ(check.exit_code, 0) << check.err;
  }
}

}  // namespace
}  // namespace palpate
