#include "precompute/process/supervised_build.h"

#include <chrono>
#include <csignal>
#include <functional>
#include <thread>

#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "precompute/process/interrupt.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr int kWasInterrupted = 70;
constexpr int kWorkedOn = 71;

// The exit code of a process that supervises `work`, after `first`.
int supervised(
    const std::function<int(bool)>& work, const std::function<void()>& first = [] {}) {
  const pid_t pid = fork();
  if (pid == 0) {
    first();
    int code = 0;
    try {
      code = run_supervised(work);
    } catch (const Interrupted&) {
      code = kWasInterrupted;
    }
    _exit(code);
  }
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

// As one that a library started, which blocks no signal.
void take_interrupt_on_another_thread() {
  std::thread([] {
    sigset_t none;
    sigemptyset(&none);
    pthread_sigmask(SIG_SETMASK, &none, nullptr);
    std::raise(SIGINT);
  }).join();
}

TEST(SupervisedBuild, ReturnsTheCodeOfItsWork) {
  EXPECT_EQ(supervised(
                [](bool) {
                  return 7;
                },
                [] {}),
            7);
}

TEST(SupervisedBuild, AnInterruptBeforeThereIsAChildIsNotLost) {
  const auto work = [](bool) {
    std::this_thread::sleep_for(3s);
    return kWorkedOn;
  };
  const auto first = [] {
    pthread_atfork(take_interrupt_on_another_thread, nullptr, nullptr);
  };
  EXPECT_EQ(supervised(work, first), kWasInterrupted);
}

TEST(SupervisedBuild, AnInterruptOfTheParentAloneReachesTheWork) {
  const auto work = [](bool) {
    note_interrupts();
    kill(getppid(), SIGINT);
    for (int i = 0; i < 300; ++i) {
      std::this_thread::sleep_for(10ms);
      try {
        check_interrupted();
      } catch (const Interrupted&) {
        return kWasInterrupted;
      }
    }
    return kWorkedOn;
  };
  EXPECT_EQ(supervised(work), kWasInterrupted);
}

TEST(SupervisedBuild, AVertexThatCrashesIsKnownAndTheWorkGoesOn) {
  const auto work = [](bool resume) {
    if (!resume) {
      note_pressed_vertex(12);
      std::raise(SIGSEGV);
    }
    return signal_of_crash_at(12) == SIGSEGV && signal_of_crash_at(13) == 0 ? 5 : 6;
  };
  EXPECT_EQ(supervised(work), 5);
}

}  // namespace
}  // namespace palpate
