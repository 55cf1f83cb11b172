#include "runtime/stop_signals.h"

#include <csignal>

namespace palpate {
namespace {

std::atomic<bool> stop_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

extern "C" void request_stop(int /*signal*/) {
  stop_requested.store(true);
}

}  // namespace

const std::atomic<bool>& heed_stop_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::signal(signal, request_stop);
  }
  return stop_requested;
}

}  // namespace palpate
