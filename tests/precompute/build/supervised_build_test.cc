// A build whose press crashes the process goes on without that vertex.
#include "precompute/process/supervised_build.h"

#include <csignal>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "formats/database/response_database.h"
#include "formats/mesh/obj_writer.h"
#include "precompute/build/build.h"
#include "precompute/process/fault_point.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/organ_scene.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class SupervisedBuild : public testing::Test {
 protected:
  SupervisedBuild() {
    write_obj(organ(2), folder_ / "organ.obj", "an organ");
    std::ofstream(folder_ / "scene.toml") << organ_on_table("linear") << kBallOnTop
                                          << "refine = \"global\"\nverify = 0\n";
  }
  ~SupervisedBuild() override { set_fault_maker({}); }

  int build_file(const std::string& name) const {
    const Scene scene = read_scene(folder_ / "scene.toml");
    return run_supervised([&](bool resume) {
      Progress quiet(nullptr);
      const BuildReport report = build(scene,
                                       {.output = folder_ / name,
                                        .resume = resume,
                                        .precision = Precision::kFloat64},
                                       quiet);
      return static_cast<int>(report.assembly.failed);
    });
  }

  ScratchFolder folder_;
};

TEST_F(SupervisedBuild, GoesOnWithoutAVertexWhosePressCrashes) {
  EXPECT_EQ(build_file("sound.h5"), 0);
  const ResponseDatabase sound = read_database(folder_ / "sound.h5");
  const ResponseTable& before = sound.tools.front();
  std::int32_t bad = 0;
  while (before.curve(bad).depth_m.empty()) {
    ++bad;
  }
  set_fault_maker([&](FaultPlace at, std::int32_t vertex, std::span<double>) {
    if (at == FaultPlace::kWorker && vertex == bad) {
      raise(SIGSEGV);
    }
  });
  EXPECT_EQ(build_file("spoilt.h5"), 1);  // one failed node
  const ResponseDatabase spoilt = read_database(folder_ / "spoilt.h5");
  const ResponseTable& after = spoilt.tools.front();
  EXPECT_TRUE(after.curve(bad).depth_m.empty());
  const auto reason =
      static_cast<std::size_t>(after.failure.at(static_cast<std::size_t>(bad)));
  EXPECT_EQ(after.failure_reason.at(reason), "its press crashed (signal 11)");
  for (std::int64_t v = 0; v < before.nodes(); ++v) {
    if (v != bad) {
      const CurveView a = before.curve(v);
      const CurveView b = after.curve(v);
      EXPECT_TRUE(std::equal(a.force_n.begin(), a.force_n.end(), b.force_n.begin(),
                             b.force_n.end()))
          << v;
    }
  }
}

TEST_F(SupervisedBuild, ThatIsKilledSaysWhatIsKept) {
  try {
    (void)run_supervised([](bool) -> int {
      kill(getpid(), SIGKILL);
      return 0;
    });
    FAIL() << "a killed build ended well";
  } catch (const ResourceError& error) {
    EXPECT_NE(std::string(error.what()).find("--resume"), std::string::npos);
  }
}

TEST_F(SupervisedBuild, HandsOnItsExitCode) {
  EXPECT_EQ(run_supervised([](bool) {
              return 3;
            }),
            3);
}

}  // namespace
}  // namespace palpate
