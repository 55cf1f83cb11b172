// Tools of several contacts from the command line.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/database/response_database.h"
#include "formats/recording/surface_state.h"
#include "tests/support/padded_plate.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class Contacts : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ScratchFolder;
    write_database(*folder_ / "pads.h5", padded_plate(3));
    write_database(*folder_ / "bare.h5", padded_plate(3, false));
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string file(const char* name) { return (*folder_ / name).string(); }

  static ToolRun simulate(const char* database, std::vector<std::string> more) {
    std::vector<std::string> arguments{"simulate", file(database), "--seconds", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_tool_process("palpate-run", arguments);
  }

  static void expect_refused(const ToolRun& run, const std::string& why) {
    EXPECT_EQ(run.exit_code, 2) << run.out << run.err;
    EXPECT_NE(run.err.find(why), std::string::npos) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }

  static std::string text(const char* name) { return bytes_of(*folder_ / name); }

 private:
  static inline ScratchFolder* folder_ = nullptr;
};

TEST_F(Contacts, AreTracedAndReplayedBitForBit) {
  const ToolRun first =
      simulate("pads.h5", {"--tool", "pads", "--trace", file("a.csv")});
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_NE(first.out.find("3, coupled"), std::string::npos) << first.out;
  const ToolRun again = simulate("pads.h5", {"--tool", "pads", "--poses", file("a.csv"),
                                             "--trace", file("b.csv")});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_GT(text("a.csv").size(), 100000U);
  EXPECT_EQ(text("a.csv"), text("b.csv"));
}

TEST_F(Contacts, TwoHandsPressTogetherAndAreRecordedAndReplayed) {
  const ToolRun run =
      simulate("pads.h5", {"--tool", "ball,ball", "--together", "--at",
                           "-0.007,0,0,0.007,0,0", "--record", file("r.h5")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("2, coupled"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("\"ball\" together with \"ball\""), std::string::npos)
      << run.out;
  const auto replay = [](std::vector<std::string> more) {
    std::vector<std::string> arguments{"replay", file("r.h5")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_tool_process("palpate-run", arguments);
  };
  const ToolRun again = replay({file("pads.h5")});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.out.find("reproduced: 2000 ticks bit for bit"), std::string::npos)
      << again.out;
  expect_refused(replay({file("bare.h5")}), "is not the database of the recording");
  expect_refused(replay({file("pads.h5"), "--model", "element"}),
                 "by potential or facets, not by element");
  EXPECT_EQ(replay({file("pads.h5"), "--model", "facets"}).exit_code, 0);
}

TEST_F(Contacts, WhatTheyDoNotHaveIsRefusedAndNotPassedOver) {
  expect_refused(simulate("pads.h5", {"--tool", "pads", "--at", "0.1,0.2"}),
                 "--at has 2 coordinates");
  expect_refused(simulate("pads.h5", {"--tool", "pads", "--model", "element"}),
                 "potential");
  expect_refused(simulate("pads.h5", {"--tool", "ball,ball", "--together", "--record",
                                      file("a.h5"), "--record", file("b.h5")}),
                 "--record is given 2 times");
  expect_refused(simulate("pads.h5", {"--tool", "ball", "--together"}),
                 "must be two as --tool a,b");
  expect_refused(simulate("bare.h5", {"--tool", "pads"}), "no table of compliance");
}

TEST_F(Contacts, HangByACoupling) {
  const ToolRun run =
      simulate("pads.h5", {"--tool", "pads", "--coupling", "--coupling-spring-n-per-m",
                           "200", "--coupling-mass-kg", "0.05"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("tool of 0.05 kg on springs of 200 N/m"), std::string::npos)
      << run.out;
  expect_refused(simulate("pads.h5", {"--tool", "pads", "--coupling-mass-kg", "0.05"}),
                 "without --coupling");
  expect_refused(
      simulate("pads.h5", {"--tool", "pads", "--coupling", "--coupling-mass-kg", "0"}),
      "must be above zero");
  expect_refused(simulate("pads.h5", {"--tool", "ball", "--coupling"}),
                 "touches at one place");
  const ToolRun kept =
      simulate("pads.h5", {"--tool", "pads", "--coupling", "--record", file("c.h5")});
  EXPECT_EQ(kept.exit_code, 0) << kept.err;
  const ToolRun again =
      run_tool_process("palpate-run", {"replay", file("c.h5"), file("pads.h5")});
  EXPECT_EQ(again.exit_code, 0) << again.out << again.err;
}

// On the clock of the wall, and what was recorded of a device of theirs.
TEST_F(Contacts, AreRenderedAndRecordedInRealTime) {
  const ToolRun real = simulate(
      "pads.h5", {"--tool", "ball,ball", "--together", "--at", "-0.007,0,0,0.007,0,0",
                  "--clock", "real", "--record", file("real.h5")});
  EXPECT_EQ(real.exit_code, 0) << real.err;
  const ToolRun device = run_tool_process(
      "palpate-run",
      {"device", file("pads.h5"), "--tool", "pads", "--device", "emulated-falcon",
       "--seconds", "1", "--limit-stiffness", "--record", file("device.h5")});
  EXPECT_EQ(device.exit_code, 0) << device.err;
  for (const char* recorded : {"real.h5", "device.h5"}) {
    const ToolRun again =
        run_tool_process("palpate-run", {"replay", file(recorded), file("pads.h5")});
    EXPECT_EQ(again.exit_code, 0) << again.out << again.err;
  }
}

// On a device in real time, and watched by whatever page there is.
TEST_F(Contacts, AreWatchedOnADevice) {
  for (const bool watched : {false, true}) {
    std::vector<std::string> arguments{watched ? "view" : "device", file("pads.h5")};
    for (const char* more : {"--tool", "pads", "--device", "emulated-falcon",
                             "--seconds", "1", "--limit-stiffness", "--coupling"}) {
      arguments.emplace_back(more);
    }
    const ToolRun run = run_tool_process("palpate-run", arguments);
    EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
    EXPECT_NE(run.out.find("3, coupled"), std::string::npos) << run.out;
    EXPECT_NE(run.out.find("of the coupling"), std::string::npos) << run.out;
  }
}

// Two hands, each on a device of its own, seen and recorded.
TEST_F(Contacts, ArePinchedByTwoDevices) {
  for (const bool watched : {false, true}) {
    std::vector<std::string> arguments{watched ? "view" : "device", file("pads.h5")};
    for (const char* more :
         {"--tool", "ball,pads", "--together", "--device", "emulated-falcon",
          "--second-device", "emulated-haply", "--at", "-0.012,0,0,0.012,0,0",
          "--seconds", "1", "--limit-stiffness"}) {
      arguments.emplace_back(more);
    }
    if (!watched) {
      for (const std::string& more :
           {std::string("--json"), std::string("--record"), file("both.h5"),
            std::string("--surface-out"), file("both.surface")}) {
        arguments.push_back(more);
      }
    }
    const ToolRun run = run_tool_process("palpate-run", arguments);
    EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
    if (watched) {
      EXPECT_NE(run.out.find("second hand's wire"), std::string::npos) << run.out;
      continue;
    }
    const nlohmann::json report = nlohmann::json::parse(run.out);
    EXPECT_EQ(report["contacts"], 4);
    EXPECT_EQ(report["second_tool"], "pads");
    EXPECT_NE(report["device"], report["second_device"]);
    EXPECT_GT(report["wire"]["transactions"], 500);
    EXPECT_GT(report["second_wire"]["transactions"], 500);
  }
  const ToolRun again =
      run_tool_process("palpate-run", {"replay", file("both.h5"), file("pads.h5")});
  EXPECT_EQ(again.exit_code, 0) << again.out << again.err;
  const SurfaceState left = read_surface_state(file("both.surface"));
  EXPECT_EQ(left.tool.count("ball") + left.tool.count("pads"), 2U);
}

// The page itself: view_hands_page_test.cc.
TEST_F(Contacts, TheViewRefusesWhatItCannotShow) {
  const auto view = [](const char* database, std::vector<std::string> more) {
    std::vector<std::string> arguments{"view", file(database)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_tool_process("palpate-run", arguments);
  };
  expect_refused(view("bare.h5", {"--tool", "pads"}), "no table of compliance");
  expect_refused(view("pads.h5", {"--tool", "ball", "--together"}),
                 "must be two as --tool a,b");
  expect_refused(view("pads.h5", {"--tool", "ball,pads"}), "--together");
  expect_refused(view("pads.h5", {"--tool", "pads", "--model", "element"}),
                 "potential");
  expect_refused(view("pads.h5", {"--tool", "ball,ball", "--together", "--device",
                                  "emulated-falcon"}),
                 "give --second-device");
  expect_refused(view("pads.h5", {"--tool", "pads", "--device", "emulated-falcon",
                                  "--second-device", "emulated-falcon"}),
                 "give --together");
  expect_refused(view("pads.h5", {"--tool", "ball,ball", "--together", "--device",
                                  "emulated-falcon", "--second-device", "falcn"}),
                 "second device: --device falcn: unknown");
  expect_refused(view("pads.h5", {"--tool", "pads", "--coupling"}), "give --device");
}

}  // namespace
}  // namespace palpate
