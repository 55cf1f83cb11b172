#include "precompute/process/interrupt.h"

#include <chrono>
#include <csignal>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr int kNoted = 7;
constexpr int kMissed = 8;
constexpr int kForeign = 9;

[[noreturn]] void end_when_noted() {
  for (int i = 0; i < 500; ++i) {
    try {
      check_interrupted();
    } catch (const Interrupted&) {
      _exit(kNoted);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  _exit(kMissed);
}

// As METIS has one while it orders a matrix in some thread.
TEST(Interrupt, IsNotedWhileALibraryHasAHandlerOfItsOwn) {
  GTEST_FLAG_SET(death_test_style, "fast");  // a process without other threads
  for (const int signal : {SIGTERM, SIGINT}) {
    EXPECT_EXIT(
        {
          note_interrupts();
          std::signal(signal, [](int /*signal*/) {
            _exit(kForeign);
          });
          kill(getpid(), signal);
          end_when_noted();
        },
        testing::ExitedWithCode(kNoted), "");
  }
}

TEST(Interrupt, ASecondOneEndsTheProcess) {
  EXPECT_EXIT(
      {
        note_interrupts();
        kill(getpid(), SIGTERM);
        while (true) {  // until the first is noted, and on
          std::this_thread::sleep_for(std::chrono::milliseconds(50));
          kill(getpid(), SIGTERM);
        }
      },
      testing::ExitedWithCode(130), "");
}

}  // namespace
}  // namespace palpate
