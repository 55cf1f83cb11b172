// Memory, processes and disks that are wanting for a while, and two builds of one
// output: the file ends with the bytes of an undisturbed build, or none is written, the
// error says to try again, and what was solved is kept.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <new>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "formats/mesh/obj_writer.h"
#include "precompute/build/build.h"
#include "precompute/process/fault_point.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/organ_scene.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

class BuildWants : public testing::Test {
 protected:
  BuildWants() {
    write_obj(organ(2), folder_ / "organ.obj", "an organ");
    std::ofstream(folder_ / "scene.toml") << organ_on_table("linear") << kBallOnTop
                                          << "refine = \"global\"\nverify = 2\n";
  }
  ~BuildWants() override { set_fault_maker({}); }

  BuildReport build_it(const BuildOptions& options) const {
    Progress quiet(nullptr);
    BuildOptions all = options;
    all.precision = Precision::kFloat64;
    all.workers = 1;
    return build(read_scene(folder_ / "scene.toml"), all, quiet);
  }

  // The bytes of an undisturbed build; nothing is left of it.
  std::string undisturbed() const {
    (void)build_it({.output = out_});
    std::string bytes = bytes_of(out_);
    fs::remove(out_);
    return bytes;
  }

  // The n-th press of any vertex finds no memory; from then on every one, or once.
  void want_memory(int from, bool once) {
    set_fault_maker(
        [=, presses = 0](FaultPlace at, std::int32_t, std::span<double>) mutable {
          if (at == FaultPlace::kWorker && ++presses >= from &&
              (!once || presses == from)) {
            throw std::bad_alloc();
          }
        });
  }

  // What the build says that is thrown; empty if it ends well.
  std::string want_of(const BuildOptions& options) const {
    try {
      (void)build_it(options);
    } catch (const ResourceError& error) {
      EXPECT_EQ(error.exit_code(), 75);
      return error.what();
    }
    return {};
  }

  const ScratchFolder folder_;
  const fs::path out_ = folder_ / "out.h5";
  const fs::path partial_ = folder_ / "out.h5.partial";
};

TEST_F(BuildWants, MemoryThatIsWantingOnceCostsNothing) {
  const std::string bytes = undisturbed();
  want_memory(5, true);
  const BuildReport report = build_it({.output = out_, .patience_s = 60.0});
  EXPECT_EQ(report.assembly.failed, 0);
  EXPECT_TRUE(bytes_of(out_) == bytes);
}

TEST_F(BuildWants, MemoryThatIsWantingForGoodEndsTheBuildAndLosesNothing) {
  const std::string bytes = undisturbed();
  const Eigen::Index vertices = organ(2).position_m.rows();
  set_fault_maker([&](FaultPlace at, std::int32_t vertex, std::span<double>) {
    if (at == FaultPlace::kWorker && vertex >= vertices) {  // a check's place
      throw std::bad_alloc();
    }
  });
  const std::string want = want_of({.output = out_, .patience_s = 0.2});
  EXPECT_NE(want.find("2 of 3 units could not be solved: its press needed more memory"),
            std::string::npos)
      << want;
  EXPECT_NE(want.find("--resume"), std::string::npos) << want;
  EXPECT_FALSE(fs::exists(out_));
  set_fault_maker({});
  const BuildReport report = build_it({.output = out_, .resume = true});
  EXPECT_EQ(report.resumed, 1);
  EXPECT_TRUE(bytes_of(out_) == bytes);
}

TEST_F(BuildWants, AUnitThatTheDiskDoesNotTakeIsInTheFileAllTheSame) {
  const std::string bytes = undisturbed();
  set_fault_maker([&](FaultPlace, std::int32_t, std::span<double>) {
    fs::create_directories(partial_ / "unit-000000");
  });
  const BuildReport report = build_it({.output = out_});
  EXPECT_EQ(report.assembly.failed, 0);
  EXPECT_TRUE(bytes_of(out_) == bytes);
  ASSERT_FALSE(report.notes.empty());
  EXPECT_NE(report.notes.back().find("1 of 3 units are kept nowhere but in the output"),
            std::string::npos)
      << report.notes.back();
}

TEST_F(BuildWants, AFolderThatSomebodyTakesAwayCostsNothing) {
  const std::string bytes = undisturbed();
  set_fault_maker([&](FaultPlace, std::int32_t, std::span<double>) {
    fs::remove_all(partial_);
  });
  const BuildReport report = build_it({.output = out_});
  EXPECT_EQ(report.assembly.failed, 0);
  EXPECT_TRUE(bytes_of(out_) == bytes);
}

TEST_F(BuildWants, ASecondBuildOfOneOutputIsToldWhoIsAtIt) {
  fs::create_directories(partial_);
  {
    const FolderLock first(partial_, FolderUse::kAlone);
    const std::string want = want_of({.output = out_});
    EXPECT_NE(want.find("process " + std::to_string(getpid()) + " on "),
              std::string::npos)
        << want;
    EXPECT_NE(want.find("works on " + partial_.string() + " already"),
              std::string::npos)
        << want;
    EXPECT_NE(want_of({.output = out_, .resume = true, .patience_s = 0.3}), "");
    EXPECT_FALSE(fs::exists(out_));
  }
  {
    const FolderLock service(partial_, FolderUse::kShared);
    EXPECT_NE(want_of({.output = out_}), "");
    EXPECT_NO_THROW((void)build_it({.output = out_, .folder_use = FolderUse::kShared}));
  }
  EXPECT_TRUE(fs::exists(out_));
}

// A task that was put into the queue again while its first copy still runs.
TEST_F(BuildWants, AResumedBuildTakesWhatTheFirstHasFinishedMeanwhile) {
  const std::string bytes = undisturbed();
  std::thread second;
  set_fault_maker([&](FaultPlace, std::int32_t, std::span<double>) {
    if (!second.joinable()) {
      second = std::thread([&] {
        const BuildReport report =
            build_it({.output = out_, .resume = true, .patience_s = 60.0});
        EXPECT_EQ(report.resumed, report.units);
        EXPECT_GT(report.assembly.solved, 0);
        EXPECT_EQ(report.assembly.failed, 0);
      });
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
    }
  });
  (void)build_it({.output = out_});
  ASSERT_TRUE(second.joinable());
  second.join();
  EXPECT_TRUE(bytes_of(out_) == bytes);
  EXPECT_FALSE(fs::exists(partial_));
}

TEST_F(BuildWants, AFileWithMoreResponsesStays) {
  (void)build_it({.output = out_});
  const std::string better = bytes_of(out_);
  std::int32_t bad = -1;
  set_fault_maker([&](FaultPlace at, std::int32_t vertex, std::span<double>) {
    bad = bad < 0 ? vertex : bad;
    if (at == FaultPlace::kWorker && vertex == bad) {
      throw NumericalError("the floor fell in");
    }
  });
  EXPECT_THROW((void)build_it({.output = out_}), NumericalError);
  EXPECT_TRUE(bytes_of(out_) == better);
}

}  // namespace
}  // namespace palpate
