#include "precompute/process/run_in_child.h"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "precompute/process/peak_memory.h"
#include "precompute/process/random_sequence.h"
#include "tests/support/comes_true.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

TEST(RunInChild, ReturnsWhatTheWorkReturned) {
  std::vector<char> sent(5'000'000);  // more than a pipe holds
  for (std::size_t i = 0; i < sent.size(); ++i) {
    sent[i] = static_cast<char>(i % 251);
  }
  const ChildResult result = run_in_child(
      [&] {
        return sent;
      },
      {});
  ASSERT_TRUE(result.done) << result.failure;
  EXPECT_EQ(result.bytes, sent);
}

TEST(RunInChild, DrawsRandomNumbersWhateverOtherThreadsDraw) {
  std::atomic<bool> enough = false;
  std::thread other([&] {
    while (!enough) {
      const std::lock_guard lock(random_sequence_mutex());
      for (int i = 0; i < 1000; ++i) {
        (void)random();
      }
    }
  });
  bool all = true;
  for (int i = 0; i < 100 && all; ++i) {
    all = run_in_child(
              [] {
                srandom(1);
                return std::vector<char>{'x'};
              },
              {.time_s = 10.0})
              .done;
  }
  enough = true;
  other.join();
  EXPECT_TRUE(all);
}

// A child that has taken another's pipe with it holds that open until it ends itself.
TEST(RunInChild, NoChildWaitsForAnotherThatTakesLonger) {
  const ScratchFolder folder;
  const std::string all_seen = folder / "seen";
  constexpr int kSlow = 6;
  constexpr int kQuick = 6;
  std::atomic<int> quick = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < kSlow; ++i) {
    threads.emplace_back([&] {
      (void)run_in_child(
          [&] {
            while (!std::filesystem::exists(all_seen)) {
              usleep(1000);
            }
            return std::vector<char>{};
          },
          {});
    });
  }
  for (int i = 0; i < kQuick; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < 20; ++k) {
        (void)run_in_child(
            [] {
              return std::vector<char>{};
            },
            {});
      }
      ++quick;
    });
  }
  EXPECT_TRUE(comes_true(
      [&] {
        return quick == kQuick;
      },
      std::chrono::seconds(60)))
      << "children that end at once were waited for as long as slow ones";
  std::ofstream(all_seen) << "yes";
  for (std::thread& thread : threads) {
    thread.join();
  }
}

TEST(RunInChild, LeavesTheCallersMemoryAlone) {
  int touched = 0;
  const ChildResult result = run_in_child(
      [&] {
        touched = 1;
        return std::vector<char>{'x'};
      },
      {});
  EXPECT_TRUE(result.done);
  EXPECT_EQ(touched, 0);
}

TEST(RunInChild, SurvivesAbortExitAndThrow) {
  const auto failure = [](auto end) {
    const ChildResult result = run_in_child(
        [&]() -> std::vector<char> {
          end();
          return {};
        },
        {});
    EXPECT_FALSE(result.done);
    return result.failure;
  };
  EXPECT_NE(failure([] {
              std::abort();
            }).find("signal 6"),
            std::string::npos);
  EXPECT_NE(failure([] {
              _exit(7);
            }).find("code 7"),
            std::string::npos);
  EXPECT_NE(failure([] {
              throw std::runtime_error("no");
            }).find("threw"),
            std::string::npos);
}

TEST(RunInChild, EndsWorkThatTakesTooLong) {
  const ChildResult result = run_in_child(
      []() -> std::vector<char> {
        while (true) {
          (void)cpu_seconds();  // reads a clock, which is work
        }
      },
      {.time_s = 0.05});
  EXPECT_FALSE(result.done);
  EXPECT_TRUE(result.at_limit);
  EXPECT_EQ(result.failure, "it took longer than 0.05 s");
}

// What is beside it, or a machine that sleeps, is not its fault.
TEST(RunInChild, GivesWorkThatDoesNotGetAProcessorItsTime) {
  const ChildResult result = run_in_child(
      []() -> std::vector<char> {
        usleep(300'000);
        return {'x'};
      },
      {.time_s = 0.05});
  EXPECT_TRUE(result.done) << result.failure;
}

TEST(RunInChild, TriesAgainWhereItWasKilled) {
  const ScratchFolder folder;
  const std::string mark = folder / "killed";
  const ChildResult result = run_in_child(
      [&]() -> std::vector<char> {
        if (!std::filesystem::exists(mark)) {
          std::ofstream(mark) << "once";
          std::raise(SIGKILL);
        }
        return {'x'};
      },
      {});
  EXPECT_TRUE(result.done) << result.failure;
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(RunInChild, EndsWorkThatTakesTooMuchMemory) {
  const ChildResult result = run_in_child(
      [] {
        return std::vector<char>(200'000'000, 'x');
      },
      {.memory_bytes = 50'000'000});
  EXPECT_FALSE(result.done);
  EXPECT_NE(result.failure.find("0.05 GB"), std::string::npos) << result.failure;
}
#endif

TEST(RunInChild, ReportsThatTheUserInterrupted) {
  const auto interrupted = [] {
    (void)run_in_child(
        []() -> std::vector<char> {
          std::raise(SIGINT);
          return {};
        },
        {});
  };
  EXPECT_THROW(interrupted(), Interrupted);
}

}  // namespace
}  // namespace palpate
