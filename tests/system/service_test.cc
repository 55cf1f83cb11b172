// A scene's service: what it hands out, what it leaves, and what it survives.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "formats/base/input_file.h"
#include "formats/database/response_database.h"
#include "formats/service/service_socket.h"
#include "tests/support/organ_scene.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

// One cluster of seven places and a check, by so large a ball that meshes are coarse.
const std::string kServedScene = organ_on_table("linear") + R"([[tool]]
name = "fingertip"
shape = "sphere"
radius_m = 0.06
[reach]
box_m = [[-1.0, -1.0, 0.0445], [1.0, 1.0, 1.0]]
depth_max_m = 0.004
[accuracy]
force_relative = 0.3
contact_resolution = 1.0
depths = 4
refine = "global"
verify = 1
)";

// Everything that a service says, as one who joined hears it.
struct Heard {
  std::optional<ServedScene> scene;
  std::map<std::int32_t, WorkUnitNode> preliminary;
  std::map<std::int32_t, WorkUnitNode> final_answer;
  std::optional<ServedEnd> end;

  void take(const ServiceMessage& message) {
    if (const auto* first = std::get_if<ServedScene>(&message)) {
      scene = *first;
    } else if (const auto* responses = std::get_if<ServedResponses>(&message)) {
      for (const WorkUnitNode& node : responses->node) {
        auto& answers =
            responses->quality == AnswerQuality::kFinal ? final_answer : preliminary;
        answers[node.vertex] = node;
      }
    } else if (const auto* last = std::get_if<ServedEnd>(&message)) {
      end = *last;
    }
  }
};

std::optional<ServiceConnection> join(const fs::path& socket) {
  for (int i = 0; i < 1000; ++i) {
    if (auto connection = ServiceConnection::join(socket)) {
      return connection;
    }
    std::this_thread::sleep_for(milliseconds(20));
  }
  return std::nullopt;
}

Heard listen_to_the_end(ServiceConnection& connection) {
  Heard heard;
  while (connection.is_open() && !heard.end) {
    if (const auto message = connection.receive(milliseconds(60000))) {
      heard.take(*message);
    }
  }
  return heard;
}

class ServiceTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<ScratchFolder>();
    std::ofstream(path("scene.toml")) << kServedScene;
    std::ofstream(path("other.toml")) << kServedScene << "# another text\n";
    const ToolRun body =
        run_tool_process("palpate-precompute",
                         {"body", "organ", "--levels", "2", "-o", path("organ.obj")});
    ASSERT_EQ(body.exit_code, 0) << body.err;
    const ToolRun whole = run_tool_process(
        "palpate-precompute", {"build", path("scene.toml"), "-o", path("whole.h5"),
                               "--precision", "float64"});
    ASSERT_EQ(whole.exit_code, 0) << whole.err;
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static std::string path(const std::string& name) {
    return (*folder_ / name).string();
  }

  static std::vector<std::string> arguments(const std::string& output,
                                            const std::string& socket,
                                            const std::string& scene = "scene.toml") {
    return {"serve",    path(scene),  "-o",          path(output),
            "--socket", path(socket), "--precision", "float64"};
  }

  static std::unique_ptr<ScratchFolder> folder_;
};

std::unique_ptr<ScratchFolder> ServiceTest::folder_;

TEST_F(ServiceTest, AnswersAllAndLeavesTheBytesOfABuild) {
  std::thread service([] {
    const ToolRun run = run_tool_process("palpate-precompute", arguments("a.h5", "a"));
    EXPECT_EQ(run.exit_code, 0) << run.err;
  });
  auto foreign = join(path("a"));
  ASSERT_TRUE(foreign);
  const std::string nonsense = "GET / HTTP/1.1\r\n\r\n";
  EXPECT_TRUE(foreign->send(std::as_bytes(std::span(nonsense)), milliseconds(1000)));
  auto connection = join(path("a"));
  ASSERT_TRUE(connection);
  EXPECT_TRUE(
      connection->send(HandPlace{.position_m = {0.0, 0.0, 0.05}}, milliseconds(1000)));
  const Heard heard = listen_to_the_end(*connection);
  connection->close();
  service.join();

  ASSERT_TRUE(heard.scene && heard.end);
  EXPECT_EQ(heard.end->failure, "");
  EXPECT_EQ(heard.end->file, heard.scene->output);
  EXPECT_EQ(read_file(path("a.h5")), read_file(path("whole.h5")));
  EXPECT_FALSE(fs::exists(path("a.h5.partial")));
  EXPECT_FALSE(fs::exists(path("a")));

  const ResponseDatabase whole = read_database(path("whole.h5"));
  const ResponseTable& table = whole.tools.front();
  ASSERT_GT(heard.scene->reachable.size(), 5U);
  EXPECT_FALSE(heard.preliminary.empty());
  for (const std::int32_t v : heard.scene->reachable) {
    ASSERT_TRUE(heard.final_answer.contains(v)) << v;
    const NodeResponse& final_answer = heard.final_answer.at(v).response;
    const CurveView stored = table.curve(v);
    EXPECT_TRUE(std::equal(stored.force_n.begin(), stored.force_n.end(),
                           final_answer.force_n.begin(), final_answer.force_n.end()))
        << v;
    // Preliminary answers are the same press on a mesh that is half as fine.
    if (heard.preliminary.contains(v)) {
      const NodeResponse& preliminary = heard.preliminary.at(v).response;
      EXPECT_NEAR(preliminary.force_n.back(), final_answer.force_n.back(),
                  0.3 * final_answer.force_n.back())
          << v;
    }
  }
}

TEST_F(ServiceTest, WhoComesLateHearsEverything) {
  ASSERT_EQ(
      run_tool_process("palpate-precompute", arguments("late.h5", "late")).exit_code,
      0);
  // The database is there: the service says so and ends.
  std::thread again([] {
    EXPECT_EQ(
        run_tool_process("palpate-precompute", arguments("late.h5", "late")).exit_code,
        0);
  });
  auto connection = join(path("late"));
  ASSERT_TRUE(connection);
  const Heard heard = listen_to_the_end(*connection);
  connection->close();
  again.join();
  ASSERT_TRUE(heard.scene && heard.end);
  EXPECT_EQ(heard.end->file, path("late.h5"));
}

TEST_F(ServiceTest, KilledAtTwentyMomentsGoesOn) {
  int cut_short = 0;
  for (int i = 0; i < 20; ++i) {
    const auto at = std::chrono::steady_clock::now() + milliseconds(40 + 20 * i);
    const ToolRun run =
        kill_tool_process("palpate-precompute", arguments("killed.h5", "k"), [&] {
          return std::chrono::steady_clock::now() > at;
        });
    cut_short += run.exit_code == 128 + SIGKILL ? 1 : 0;
  }
  EXPECT_GT(cut_short, 0);
  const ToolRun run =
      run_tool_process("palpate-precompute", arguments("killed.h5", "k"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_file(path("killed.h5")), read_file(path("whole.h5")));
}

TEST_F(ServiceTest, TwoShareOneScene) {
  std::thread other([] {
    const ToolRun run =
        run_tool_process("palpate-precompute", arguments("shared.h5", "one"));
    EXPECT_EQ(run.exit_code, 0) << run.err;
  });
  const ToolRun run =
      run_tool_process("palpate-precompute", arguments("shared.h5", "two"));
  other.join();
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_file(path("shared.h5")), read_file(path("whole.h5")));
}

// As soon as a service has made its folder, does something to it. A service that never
// ends is killed.
ToolRun serve_and_meanwhile(const std::vector<std::string>& arguments,
                            const fs::path& folder,
                            const std::function<void()>& meanwhile) {
  const auto late = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  bool done = false;
  return kill_tool_process("palpate-precompute", arguments, [&] {
    if (!done && fs::exists(folder / "digest")) {
      meanwhile();
      done = true;
    }
    return std::chrono::steady_clock::now() > late;
  });
}

TEST_F(ServiceTest, EndsWhereAnotherHasPutTheFileTogether) {
  const fs::path folder = path("quick.h5.partial");
  const ToolRun run =
      serve_and_meanwhile(arguments("quick.h5", "q"), folder, [&folder] {
        fs::copy_file(path("whole.h5"), path("quick.h5"));
        fs::remove_all(folder);
      });
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_file(path("quick.h5")), read_file(path("whole.h5")));
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(ServiceTest, GoesOnWhereItsFolderIsTakenAway) {
  const fs::path folder = path("bare.h5.partial");
  const ToolRun run = serve_and_meanwhile(arguments("bare.h5", "b"), folder, [&folder] {
    fs::remove_all(folder);
  });
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_file(path("bare.h5")), read_file(path("whole.h5")));
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(ServiceTest, SubmitStartsServicesThatShareTheScene) {
  const std::vector<std::string> wanted = {"submit",   path("scene.toml"),
                                           "-o",       path("many.h5"),
                                           "--engine", "local",
                                           "--serve",  "--nodes",
                                           "2",        "--threads",
                                           "1",        "--precision",
                                           "float64",  "--run"};
  const ToolRun run = run_tool_process("palpate-precompute", wanted);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("services"), std::string::npos) << run.out;
  EXPECT_EQ(read_file(path("many.h5")), read_file(path("whole.h5")));
  std::vector<std::string> shards = wanted;
  shards.insert(shards.end(), {"--shards", "3"});
  const ToolRun refused = run_tool_process("palpate-precompute", shards);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("leave out --shards"), std::string::npos) << refused.err;
}

TEST_F(ServiceTest, AnotherScenesWorkIsRefusedUnlessWantedAnew) {
  fs::copy_file(path("whole.h5"), path("other.h5"));
  auto wanted = arguments("other.h5", "o", "other.toml");
  const ToolRun refused = run_tool_process("palpate-precompute", wanted);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("--anew"), std::string::npos) << refused.err;
  EXPECT_EQ(read_file(path("other.h5")), read_file(path("whole.h5")));
  wanted.push_back("--anew");
  const ToolRun anew = run_tool_process("palpate-precompute", wanted);
  EXPECT_EQ(anew.exit_code, 0) << anew.err;
  EXPECT_NE(read_file(path("other.h5")), read_file(path("whole.h5")));
}

// All that a file depends on counts, not only the scene's text and the body.
TEST_F(ServiceTest, AFileOfAnotherToolMeshIsComputedAgain) {
  const auto write_tool = [](double half_mm) {
    std::ofstream tool(path("tool.obj"));
    for (const double z : {0.0, 20.0}) {
      for (const double y : {-half_mm, half_mm}) {
        for (const double x : {-half_mm, half_mm}) {
          tool << "v " << x << ' ' << y << ' ' << z << '\n';
        }
      }
    }
    tool << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 2 4 8 6\nf 4 3 7 8\nf 3 1 5 7\n";
  };
  std::string text = kServedScene;
  const auto put = [&text](const std::string& here, const std::string& instead) {
    text.replace(text.find(here), here.size(), instead);
  };
  put("shape = \"sphere\"\nradius_m = 0.06",
      "shape = \"mesh\"\nmesh = \"tool.obj\"\nlength_unit = \"mm\"");
  put("0.0445", "0.0460");  // two places
  put("verify = 1", "verify = 0");
  std::ofstream(path("tooled.toml")) << text;
  write_tool(30.0);
  ASSERT_EQ(
      run_tool_process("palpate-precompute", arguments("tooled.h5", "t", "tooled.toml"))
          .exit_code,
      0);
  const std::string first = bytes_of(path("tooled.h5"));
  write_tool(20.0);
  const ToolRun refused = run_tool_process("palpate-precompute",
                                           arguments("tooled.h5", "t", "tooled.toml"));
  EXPECT_EQ(refused.exit_code, 2) << refused.err;
  std::vector<std::string> anew = arguments("tooled.h5", "t", "tooled.toml");
  anew.emplace_back("--anew");
  const ToolRun again = run_tool_process("palpate-precompute", anew);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_FALSE(bytes_of(path("tooled.h5")) == first);
}

TEST_F(ServiceTest, WhoListensAlreadyIsNamed) {
  const ServiceListener listener(path("taken"));
  const ToolRun run =
      run_tool_process("palpate-precompute", arguments("t.h5", "taken"));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("listens"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace palpate
