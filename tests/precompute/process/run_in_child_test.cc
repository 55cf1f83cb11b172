#include "precompute/process/run_in_child.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "precompute/process/die_with_parent.h"
#include "precompute/process/peak_memory.h"
#include "tests/support/comes_true.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

std::vector<char> nothing(std::span<const char> /*input*/) {
  return {};
}

std::string text_of(std::span<const char> input) {
  return {input.begin(), input.end()};
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(RunInChild, ReturnsWhatTheWorkMadeOfItsInput) {
  std::vector<char> sent(5'000'000);  // more than a pipe holds
  for (std::size_t i = 0; i < sent.size(); ++i) {
    sent[i] = static_cast<char>(i % 251);
  }
  const ChildResult result = run_in_child(
      [](std::span<const char> input) {
        return std::vector<char>(input.rbegin(), input.rend());
      },
      sent, {});
  ASSERT_TRUE(result.done) << result.failure;
  EXPECT_TRUE(
      std::equal(sent.rbegin(), sent.rend(), result.bytes.begin(), result.bytes.end()));
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
          [](std::span<const char> input) {
            while (!std::filesystem::exists(text_of(input))) {
              usleep(1000);
            }
            return std::vector<char>{};
          },
          all_seen, {});
    });
  }
  for (int i = 0; i < kQuick; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < 20; ++k) {
        (void)run_in_child(nothing, {}, {});
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

int g_touched = 0;

TEST(RunInChild, LeavesTheCallersMemoryAlone) {
  const ChildResult result = run_in_child(
      [](std::span<const char>) {
        g_touched = 1;
        return std::vector<char>{'x'};
      },
      {}, {});
  EXPECT_TRUE(result.done);
  EXPECT_EQ(g_touched, 0);
}

TEST(RunInChild, SurvivesAbortExitAndThrow) {
  const auto failure = [](ChildWork work) {
    const ChildResult result = run_in_child(work, {}, {});
    EXPECT_FALSE(result.done);
    return result.failure;
  };
  EXPECT_TRUE(has(failure([](auto) -> std::vector<char> {
                    std::abort();
                  }),
                  "signal 6"));
  EXPECT_TRUE(has(failure([](auto) -> std::vector<char> {
                    _exit(7);
                  }),
                  "code 7"));
  EXPECT_TRUE(has(failure([](auto) -> std::vector<char> {
                    throw std::runtime_error("no");
                  }),
                  "threw"));
}

TEST(RunInChild, EndsWorkThatTakesTooLong) {
  const ChildResult result = run_in_child(
      [](auto) -> std::vector<char> {
        while (true) {
          (void)cpu_seconds();  // reads a clock, which is work
        }
      },
      {}, {.time_s = 0.05});
  EXPECT_FALSE(result.done);
  EXPECT_TRUE(result.at_limit);
  EXPECT_EQ(result.failure, "it took longer than 0.05 s");
}

// What is beside it, or a machine that sleeps, is not its fault.
TEST(RunInChild, GivesWorkThatDoesNotGetAProcessorItsTime) {
  const ChildResult result = run_in_child(
      [](auto) -> std::vector<char> {
        usleep(300'000);
        return {'x'};
      },
      {}, {.time_s = 0.05});
  EXPECT_TRUE(result.done) << result.failure;
}

TEST(RunInChild, TriesAgainWhereItWasKilled) {
  const ScratchFolder folder;
  const std::string mark = folder / "killed";
  const ChildResult result = run_in_child(
      [](std::span<const char> input) -> std::vector<char> {
        if (!std::filesystem::exists(text_of(input))) {
          std::ofstream(text_of(input)) << "once";
          std::raise(SIGKILL);
        }
        return {'x'};
      },
      mark, {});
  EXPECT_TRUE(result.done) << result.failure;
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(RunInChild, EndsWorkThatTakesTooMuchMemory) {
  const ChildResult result = run_in_child(
      [](auto) {
        return std::vector<char>(200'000'000, 'x');
      },
      {}, {.memory_bytes = 50'000'000});
  EXPECT_FALSE(result.done);
  EXPECT_TRUE(has(result.failure, "0.05 GB")) << result.failure;
}
#endif

TEST(RunInChild, ReportsThatTheUserInterrupted) {
  const auto interrupted = [] {
    (void)run_in_child(
        [](auto) -> std::vector<char> {
          std::raise(SIGINT);
          return {};
        },
        {}, {});
  };
  EXPECT_THROW(interrupted(), Interrupted);
}

pid_t answered(ChildWork work) {
  const ChildResult result = run_in_child(work, {}, {});
  pid_t number = 0;
  if (result.bytes.size() == sizeof(number)) {
    std::memcpy(&number, result.bytes.data(), sizeof(number));
  }
  return number;
}

std::vector<char> bytes_of(pid_t number) {
  const auto* first = reinterpret_cast<const char*>(&number);
  return {first, first + sizeof(number)};
}

pid_t child() {
  return answered([](auto) {
    return bytes_of(getpid());
  });
}

TEST(IdleChild, DoesOnePieceOfWorkAfterTheOther) {
  const pid_t first = child();
  EXPECT_NE(first, getpid());
  EXPECT_EQ(child(), first);
}

TEST(IdleChild, ThatEndedIsReplaced) {
  for (const int signal : {SIGKILL, SIGINT, SIGTERM, SIGSEGV}) {
    const pid_t first = child();
    kill(first, signal);
    siginfo_t ended{};
    waitid(P_PID, static_cast<id_t>(first), &ended, WEXITED | WNOWAIT);
    const pid_t second = child();
    EXPECT_NE(second, 0);
    EXPECT_NE(second, first);
  }
}

TEST(IdleChild, EndsWithTheThreadThatItCameFromAndIsReplaced) {
  end_idle_children();
  pid_t first = 0;
  std::thread([&] {
    first = child();
  }).join();
  EXPECT_TRUE(comes_true(
      [&] {
        return child() != first;
      },
      std::chrono::seconds(10)));
}

TEST(IdleChild, IsNoneAfterWorkThatFailedOrFilledTheMemory) {
  const pid_t first = child();
  (void)run_in_child(
      [](auto) -> std::vector<char> {
        throw std::runtime_error("no");
      },
      {}, {});
  const pid_t second = child();
  EXPECT_NE(second, first);
  (void)run_in_child(
      [](auto) -> std::vector<char> {
        static std::vector<char> kept(300'000'000, 'x');
        return {};
      },
      {}, {});
  const pid_t third = child();
  EXPECT_NE(third, second);
  EXPECT_NE(third, 0);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(RunInChild, LimitsWhatIsAddedToTheMemoryThatTheChildHolds) {
  const auto fill = [](auto) {
    const std::vector<char> some(30'000'000, 'x');
    return std::vector<char>(some.begin(), some.begin() + 1);
  };
  EXPECT_TRUE(run_in_child(fill, {}, {.memory_bytes = 50'000'000}).done);
}

TEST(RunInChild, LeavesALowerLimitOfTheUsersAlone) {
  rlimit users{};
  getrlimit(RLIMIT_AS, &users);
  const rlimit lower{std::min<rlim_t>(4'000'000'000, users.rlim_max), users.rlim_max};
  end_idle_children();
  ASSERT_EQ(setrlimit(RLIMIT_AS, &lower), 0);
  for (int i = 0; i < 2; ++i) {
    const ChildResult result = run_in_child(
        [](auto) {
          rlimit its{};
          getrlimit(RLIMIT_AS, &its);
          const auto* first = reinterpret_cast<const char*>(&its.rlim_cur);
          return std::vector<char>(first, first + sizeof(its.rlim_cur));
        },
        {}, {});
    rlim_t its = 0;
    ASSERT_EQ(result.bytes.size(), sizeof(its));
    std::memcpy(&its, result.bytes.data(), sizeof(its));
    EXPECT_EQ(its, lower.rlim_cur);
  }
  end_idle_children();
  setrlimit(RLIMIT_AS, &users);
}

TEST(IdleChild, IsNotHeldToTheLimitsOfEarlierWork) {
  const auto fill = [](auto) {
    return std::vector<char>(200'000'000, 'x');
  };
  EXPECT_TRUE(
      run_in_child(nothing, {}, {.time_s = 0.01, .memory_bytes = 50'000'000}).done);
  EXPECT_TRUE(run_in_child(fill, {}, {}).done);
}
#endif

// A lock on a file stays with whoever has it open.
TEST(IdleChild, KeepsNothingOpenThatItsOwnerClosed) {
  end_idle_children();
  const ScratchFolder folder;
  const std::string file = folder / "locked";
  const int held = open(file.c_str(), O_CREAT | O_RDWR, 0600);
  ASSERT_EQ(flock(held, LOCK_EX | LOCK_NB), 0);
  (void)child();
  close(held);
  const int again = open(file.c_str(), O_RDWR);
  EXPECT_EQ(flock(again, LOCK_EX | LOCK_NB), 0);
  close(again);
}

TEST(IdleChild, IsNotSharedWithAProcessForkedFromItsOwner) {
  const pid_t mine = child();
  const pid_t forked = fork();
  if (forked == 0) {
    const pid_t its = child();
    end_idle_children();
    _exit(its != 0 && its != mine ? 0 : 1);
  }
  EXPECT_EQ(wait_for_child(forked), 0);
  EXPECT_EQ(child(), mine);
}

TEST(IdleChild, ThatEndsHasItsTimeCounted) {
  const auto taken_s = [] {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  };
  end_idle_children();
  const double before_s = taken_s();
  (void)run_in_child(
      [](auto) -> std::vector<char> {
        while (cpu_seconds() < 0.2) {
        }
        return {};
      },
      {}, {});
  end_idle_children();
  EXPECT_GE(taken_s() - before_s, 0.2);
}

TEST(IdleChild, IsKeptReady) {
  end_idle_children();
  keep_children_ready(3);
  const std::string children = fmt::format("/proc/self/task/{}/children", getpid());
  std::ifstream file(children);
  EXPECT_EQ(std::distance(std::istream_iterator<pid_t>(file), {}), 3);
}

}  // namespace
}  // namespace palpate
