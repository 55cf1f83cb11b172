// Recording and replaying by the tool that a user runs, and the ways in which a run can
// end.
#include "formats/recording/recording.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/run_tool.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class RecordedRun : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    write_database(database(), body(100.0));
    write_database(other(), body(150.0));
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static ResponseDatabase body(double stiffness_n_per_m) {
    return sample_database(
        sphere_surface(0.04, 2), ball(0.005, 0.3, 5e-4),
        [=](Eigen::Index, double d) {
          return stiffness_n_per_m * d * (0.5 + 50.0 * d);
        },
        0.005);
  }

  static ScratchFolder& folder() {
    if (folder_ == nullptr) {
      folder_ = new ScratchFolder;
    }
    return *folder_;
  }
  static std::string database() { return (folder() / "body.h5").string(); }
  static std::string other() { return (folder() / "other.h5").string(); }

  ToolRun replay(std::vector<std::string> more = {},
                 const std::string& on = database()) {
    std::vector<std::string> arguments{"replay", recording_, on};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_tool_process("palpate-run", arguments);
  }

  void record(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"simulate", database(), "--seconds",
                                       "2",        "--record", recording_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ToolRun run = run_tool_process("palpate-run", arguments);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }

  ScratchFolder scratch_;
  std::string recording_ = (scratch_ / "run.h5").string();

 private:
  inline static ScratchFolder* folder_ = nullptr;
};

TEST_F(RecordedRun, IsReproducedBitForBit) {
  record();
  const ToolRun run = replay();
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out.find("reproduced: 4000 ticks bit for bit\n"), 0U) << run.out;
  const Json report = parse_json(replay({"--json"}).out);
  EXPECT_EQ(report.at("reproduced"), true);
  EXPECT_EQ(report.at("identical_ticks"), 4000);
  EXPECT_EQ(report.at("force_difference_n"), 0.0);
}

TEST_F(RecordedRun, GivesTheSameFileTwiceInSimulatedTime) {
  const auto bytes = [&] {
    std::ifstream in(recording_, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  record();
  const std::string first = bytes();
  // Nothing in it depends on when it was written, to the second.
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  record();
  EXPECT_TRUE(first == bytes());
}

TEST_F(RecordedRun, IsRenderedWithAnotherModelAndOnAnotherDatabaseOnRequest) {
  record();
  const ToolRun model = replay({"--model", "energy-tank", "--json"});
  EXPECT_EQ(model.exit_code, 0) << model.err;
  EXPECT_EQ(parse_json(model.out).at("model"), "energy-tank");
  const ToolRun refused = replay({}, other());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("is not the database of the recording, body.h5"),
            std::string::npos)
      << refused.err;
  const ToolRun allowed = replay({"--other-database", "--json"}, other());
  EXPECT_EQ(allowed.exit_code, 0) << allowed.err;
  EXPECT_GT(parse_json(allowed.out).at("force_rms_n"), 0.0);
  EXPECT_EQ(replay({"--model", "magic"}).exit_code, 2);
}

TEST_F(RecordedRun, IsRefusedInOneSentenceWhenItIsCut) {
  record();
  fs::resize_file(recording_, fs::file_size(recording_) / 2);
  const ToolRun run = replay();
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_NE(run.err.find("is truncated or damaged"), std::string::npos) << run.err;
}

TEST_F(RecordedRun, IsWholeAfterAnInterrupt) {
  const ToolRun run =
      interrupt_tool_process("palpate-run",
                             {"simulate", database(), "--seconds", "600", "--clock",
                              "real", "--record", recording_},
                             2000);
  EXPECT_EQ(run.exit_code, 130) << run.err;
  EXPECT_TRUE(read_recording(recording_).ended);
  EXPECT_EQ(replay().exit_code, 0);
}

TEST_F(RecordedRun, OfAKilledProcessIsReproducedUpToItsLastBlock) {
  const std::string partial = recording_ + ".partial";
  const auto start = std::chrono::steady_clock::now();
  const ToolRun run = kill_tool_process(
      "palpate-run",
      {"simulate", database(), "--seconds", "600", "--clock", "real", "--record",
       recording_},
      [&] {
        std::error_code missing;
        return (fs::exists(partial) && fs::file_size(partial, missing) > 500'000) ||
               std::chrono::steady_clock::now() - start > std::chrono::seconds(60);
      });
  EXPECT_EQ(run.exit_code, 128 + 9);
  EXPECT_FALSE(fs::exists(recording_));
  fs::rename(partial, recording_);
  EXPECT_GE(read_recording(recording_).tick.size(), 1024U);
  const ToolRun again = replay();
  EXPECT_EQ(again.exit_code, 0) << again.err << again.out;
  EXPECT_NE(again.out.find("cut short by the end of its writer"), std::string::npos);
}

}  // namespace
}  // namespace palpate
