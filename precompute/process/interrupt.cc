#include "precompute/process/interrupt.h"

#include <csignal>

#include <unistd.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void note(int /*signal*/) {
  if (interrupted != 0) {
    _exit(130);  // Interrupted's exit code; nothing else is safe in a signal handler
  }
  interrupted = 1;
}

}  // namespace

void note_interrupts() {
  struct sigaction action {};
  action.sa_handler = note;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void check_interrupted() {
  if (interrupted != 0) {
    throw Interrupted();
  }
}

}  // namespace palpate
