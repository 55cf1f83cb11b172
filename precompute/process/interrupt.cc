#include "precompute/process/interrupt.h"

#include <atomic>
#include <csignal>
#include <mutex>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);  // handlers may use it

void note(int /*signal*/) {
  if (interrupted.exchange(true)) {
    _exit(130);  // Interrupted's exit code; other threads are in the middle of work
  }
}

void wait_for_signals(sigset_t wanted) {
  while (true) {
    int signal = 0;
    if (sigwait(&wanted, &signal) == 0) {
      note(signal);
    }
  }
}

}  // namespace

// METIS has handlers of its own while it orders a matrix, for all threads, and jumps
// out of them: a signal that another thread gets meanwhile ends the process. So this
// thread and all that it starts block these signals, and one waits for them. The
// handler is for threads that libraries started before.
void note_interrupts() {
  sigset_t wanted;
  sigemptyset(&wanted);
  sigaddset(&wanted, SIGINT);
  sigaddset(&wanted, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &wanted, nullptr);
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
  static std::once_flag waiting;
  try {
    std::call_once(waiting, [&] {
      std::thread(wait_for_signals, wanted).detach();
    });
  } catch (const std::system_error& error) {
    throw ResourceError(fmt::format("no thread can be started: {}", error.what()));
  }
}

void check_interrupted() {
  if (interrupted) {
    throw Interrupted();
  }
}

}  // namespace palpate
