#include "runtime/realtime/stop_signals.h"

#include <csignal>

namespace palpate {
namespace {

std::atomic<bool> stop_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

extern "C" void take_stop_signal(int /*signal*/) {
  stop_requested.store(true);
}

void on_stop_signals(void (*action)(int)) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::signal(signal, action);
  }
}

}  // namespace

const std::atomic<bool>& stop_signals() {
  on_stop_signals(take_stop_signal);
  return stop_requested;
}

void request_stop() noexcept {
  stop_requested.store(true);
}

void release_stop_signals() {
  on_stop_signals(SIG_DFL);
}

}  // namespace palpate
