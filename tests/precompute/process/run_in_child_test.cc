#include "precompute/process/run_in_child.h"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "precompute/process/random_sequence.h"

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
          pause();
        }
      },
      {.time_s = 0.05});
  EXPECT_FALSE(result.done);
  EXPECT_EQ(result.failure, "it took longer than 0.05 s");
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
