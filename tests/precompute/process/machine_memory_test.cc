#include "precompute/process/machine_memory.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// Rows of factor_study [GB].
TEST(MachineMemory, TheExpectationIsWhatAnOrganNeedsAndMoreThanACylinder) {
  EXPECT_NEAR(expected_memory_bytes(5120) / 0.551e9, 1.0, 0.05);
  EXPECT_NEAR(expected_memory_bytes(20480) / 3.002e9, 1.0, 0.05);
  EXPECT_GT(expected_memory_bytes(6936) / 0.633e9, 1.0);
  EXPECT_GT(expected_memory_bytes(15000) / 1.578e9, 1.0);
  EXPECT_LT(expected_memory_bytes(15000) / 1.578e9, 1.4) << "refuses what fits";
}

TEST(MachineMemory, ABodyThatFitsIsTakenAndOneThatDoesNotIsToldWhatToDo) {
  EXPECT_GT(free_memory_bytes(), 10'000'000);
  EXPECT_NO_THROW(require_memory(4));
  try {
    require_memory(1'000'000'000'000);
    FAIL() << "was taken";
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("of 1000000000000 surface triangles needs about"),
              std::string::npos)
        << what;
    EXPECT_NE(what.find("[cutout] radius_m"), std::string::npos) << what;
  }
}

// What a system says, in files of its own.
class FakeMemory : public testing::Test {
 protected:
  FakeMemory() { say("proc/meminfo", "MemTotal: 8000 kB\nMemAvailable: 6000 kB\n"); }

  void say(const std::string& file, const std::string& text) const {
    std::filesystem::create_directories((folder_ / file).parent_path());
    std::ofstream(folder_ / file) << text;
  }
  void group(const std::string& name, const std::string& limit, std::int64_t used,
             std::int64_t files) const {
    say("groups/" + name + "/memory.max", limit + "\n");
    say("groups/" + name + "/memory.current", std::to_string(used) + "\n");
    say("groups/" + name + "/memory.stat",
        "anon 1\ninactive_file " + std::to_string(files) + "\nactive_file 7\n");
  }
  MemoryFiles files() const { return {folder_ / "proc", folder_ / "groups"}; }

  ScratchFolder folder_;
};

TEST_F(FakeMemory, IsWhatTheMachineHasWhereNoGroupSaysLess) {
  EXPECT_EQ(free_memory_bytes(files()), 6'144'000);
  EXPECT_EQ(most_memory_bytes(files()), 8'192'000);
  group("", "max", 5'000'000, 0);
  EXPECT_EQ(free_memory_bytes(files()), 6'144'000);
  EXPECT_EQ(most_memory_bytes(files()), 8'192'000);
}

TEST_F(FakeMemory, OfFilesThatWereReadIsFree) {
  group("", "2000000", 1'990'000, 1'500'000);
  EXPECT_EQ(free_memory_bytes(files()), 1'510'000);
  EXPECT_EQ(most_memory_bytes(files()), 2'000'000);
}

TEST_F(FakeMemory, IsThatOfTheTightestGroupAroundTheProcess) {
  say("proc/self/cgroup", "0::/job/step/task\n");
  group("job", "max", 5'000'000, 0);
  group("job/step", "3000000", 1'000'000, 0);
  group("job/step/task", "4000000", 1'000'000, 0);
  EXPECT_EQ(free_memory_bytes(files()), 2'000'000);
  EXPECT_EQ(most_memory_bytes(files()), 3'000'000);
}

TEST_F(FakeMemory, GroupsOfVersionOneCountToo) {
  say("proc/self/cgroup", "5:cpu,cpuacct:/a\n4:memory:/job\n");
  say("groups/memory/job/memory.limit_in_bytes", "1000000\n");
  say("groups/memory/job/memory.usage_in_bytes", "900000\n");
  say("groups/memory/job/memory.stat", "cache 9\ntotal_inactive_file 300000\n");
  EXPECT_EQ(free_memory_bytes(files()), 400'000);
  EXPECT_EQ(most_memory_bytes(files()), 1'000'000);
}

TEST_F(FakeMemory, WhatIsNotFreeIsWaitedForAndWhatIsNotThereIsRefused) {
  group("", "2000000", 1'990'000, 0);
  EXPECT_THROW(require_free_memory(3e6, 3e6, "a factor", "make it smaller", files()),
               InputError);
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    group("", "2000000", 500'000, 0);
  });
  EXPECT_NO_THROW(
      require_free_memory(1e6, 1e6, "a factor", "make it smaller", files()));
  other.join();
}

}  // namespace
}  // namespace palpate
