// A scene rendered while it is computed: the two programs, each a process of its own.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/input_file.h"
#include "formats/base/json_text.h"
#include "tests/support/comes_true.h"
#include "tests/support/organ_scene.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class SceneWhileComputed : public testing::Test {
 protected:
  // A body, and what a build makes of it, for all tests.
  static void SetUpTestSuite() {
    made_ = std::make_unique<ScratchFolder>();
    const ToolRun body = run_tool_process(
        "palpate-precompute",
        {"body", "organ", "--levels", "2", "-o", (*made_ / "organ.obj").string()});
    ASSERT_EQ(body.exit_code, 0) << body.err;
    write_scene(*made_ / "scene.toml");
    const ToolRun build = run_tool_process(
        "palpate-precompute", {"build", (*made_ / "scene.toml").string(), "-o",
                               (*made_ / "whole.h5").string()});
    ASSERT_EQ(build.exit_code, 0) << build.err;
  }
  static void TearDownTestSuite() { made_.reset(); }

  static void write_scene(const std::filesystem::path& file) {
    std::ofstream(file) << organ_on_table("linear") << kBallOnTop
                        << "refine = \"global\"\nverify = 0\n";
  }

  SceneWhileComputed() {
    std::filesystem::copy_file(*made_ / "organ.obj", folder_ / "organ.obj");
    write_scene(folder_ / "scene.toml");
  }

  [[nodiscard]] std::vector<std::string> simulate(
      const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"simulate",
                                      (folder_ / "scene.toml").string(),
                                      "-o",
                                      (folder_ / "out.h5").string(),
                                      "--wander-mm-per-s",
                                      "50",
                                      "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  static std::unique_ptr<ScratchFolder> made_;
  const ScratchFolder folder_;
};

std::unique_ptr<ScratchFolder> SceneWhileComputed::made_;

TEST_F(SceneWhileComputed, WhatWasComputedBeforeIsFeltAtOnce) {
  std::filesystem::copy_file(*made_ / "whole.h5", folder_ / "out.h5");
  const ToolRun run = run_tool_process(
      "palpate-run",
      simulate({"--seconds", "3", "--quality-csv", (folder_ / "q.csv").string()}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = parse_json(run.out);
  const auto& service = json["service"];
  EXPECT_EQ(service["state"], "done") << service;
  EXPECT_EQ(service["detail"], (folder_ / "out.h5").string());
  EXPECT_GT(service["answers"], 10);
  EXPECT_GT(service["ticks"]["final"], 1000) << service;
  EXPECT_GT(json["force_max_n"], 0.0);
  EXPECT_EQ(json["fault"], "none");
  std::ifstream csv(folder_ / "q.csv");
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "second,none,estimated,preliminary,final");
  EXPECT_TRUE(std::getline(csv, line));
  // A page looks on while a device presses it.
  const ToolRun watched =
      run_tool_process("palpate-run", {"view", (folder_ / "scene.toml").string(), "-o",
                                       (folder_ / "out.h5").string(), "--device",
                                       "emulated-inverse3", "--seconds", "2"});
  EXPECT_EQ(watched.exit_code, 0) << watched.err;
  EXPECT_EQ(watched.out.find("http://127.0.0.1:"), 0U) << watched.out;
  EXPECT_NE(watched.out.find("done: " + (folder_ / "out.h5").string()),
            std::string::npos)
      << watched.out;
}

TEST_F(SceneWhileComputed, GoesOnWhenItsServerIsKilled) {
  // A server that says who it is.
  const auto real = std::filesystem::read_symlink("/proc/self/exe").parent_path() /
                    "palpate-precompute";
  const auto server = folder_ / "server";
  const auto id = folder_ / "id";
  std::ofstream(server) << "#!/bin/sh\necho $$ > '" << id.string() << "'\nexec '"
                        << real.string() << "' \"$@\"\n";
  std::filesystem::permissions(server, std::filesystem::perms::owner_all);
  bool killed = false;
  const ToolRun run = kill_tool_process(
      "palpate-run", simulate({"--seconds", "3", "--server", server.string()}), [&] {
        pid_t process = 0;
        if (!killed && std::filesystem::exists(folder_ / "out.h5.socket") &&
            std::ifstream(id) >> process) {
          std::this_thread::sleep_for(std::chrono::milliseconds(1000));
          ::kill(-process, SIGKILL);  // and those that it has started
          killed = true;
        }
        return false;
      });
  ASSERT_TRUE(killed);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = parse_json(run.out);
  EXPECT_EQ(json["service"]["state"], "lost") << json["service"];
  EXPECT_EQ(json["fault"], "none");
  EXPECT_GT(json["ticks"], 3000);
}

TEST_F(SceneWhileComputed, KilledAtTwentyMomentsItsServiceEndsAndNothingIsLost) {
  const auto is_served = [&] {
    return std::filesystem::exists(folder_ / "out.h5.socket");
  };
  int killed = 0;
  for (int i = 0; i < 20; ++i) {
    const auto at =
        std::chrono::steady_clock::now() + std::chrono::milliseconds(30 + 20 * i);
    const ToolRun run =
        kill_tool_process("palpate-run", simulate({"--seconds", "60"}), [&] {
          return std::chrono::steady_clock::now() > at;
        });
    killed += run.exit_code == 128 + SIGKILL ? 1 : 0;
  }
  EXPECT_EQ(killed, 20);
  const ToolRun late =
      kill_tool_process("palpate-run", simulate({"--seconds", "60"}), [&] {
        return is_served();
      });
  EXPECT_EQ(late.exit_code, 128 + SIGKILL);
  EXPECT_TRUE(comes_true(
      [&] {
        return !is_served();
      },
      std::chrono::minutes(1)));
  const ToolRun rest = run_tool_process(
      "palpate-precompute", {"serve", (folder_ / "scene.toml").string(), "-o",
                             (folder_ / "out.h5").string()});
  EXPECT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_EQ(read_file(folder_ / "out.h5"), read_file(*made_ / "whole.h5"));
}

TEST_F(SceneWhileComputed, AHostInCFeelsItComeIn) {
  const auto server = std::filesystem::read_symlink("/proc/self/exe").parent_path() /
                      "palpate-precompute";
  const ToolRun run = run_tool_process(
      "c_scene_host", {(folder_ / "scene.toml").string(), (folder_ / "out.h5").string(),
                       server.string(), "0", "0", "0.0467", "0.06", "0.003"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_NE(run.out.find("final"), std::string::npos) << run.out;
}

TEST_F(SceneWhileComputed, SaysWhatIsWrong) {
  const auto view = [](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"view"};
    words.insert(words.end(), more.begin(), more.end());
    return run_tool_process("palpate-run", words);
  };
  const ToolRun missing = view({(folder_ / "none.toml").string()});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_NE(missing.err.find("no such scene"), std::string::npos) << missing.err;
  std::ofstream(folder_ / "broken.toml") << "[body]\nmesh = 3\n";
  const ToolRun broken = view(
      {(folder_ / "broken.toml").string(), "-o", (folder_ / "broken.h5").string()});
  EXPECT_EQ(broken.exit_code, 2);
  EXPECT_NE(broken.err.find("exit code 2 before it sent its scene"), std::string::npos)
      << broken.err;
  const std::string database = (*made_ / "whole.h5").string();
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"view", database, "--estimate"},
        {"simulate", database, "--server", "/nowhere"},
        {"device", "--device", "simulated", database, "-o", "elsewhere.h5"}}) {
    const ToolRun whole = run_tool_process("palpate-run", command);
    EXPECT_EQ(whole.exit_code, 2) << command.front();
    EXPECT_NE(whole.err.find("are of a scene"), std::string::npos) << whole.err;
  }
  const ToolRun server =
      view({(folder_ / "scene.toml").string(), "--server", "/nowhere"});
  EXPECT_EQ(server.exit_code, 2);
  EXPECT_NE(server.err.find("no program is there"), std::string::npos) << server.err;
}

}  // namespace
}  // namespace palpate
