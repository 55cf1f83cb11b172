// Ctrl-C: a wish that long computations look at between steps.
#pragma once

namespace palpate {

/// From now on a thread waits for SIGINT and SIGTERM and notes them; they do not end
/// the process. A second signal ends the process at once with exit code 130. To be
/// called before this process has other threads: they take over that the signals are
/// blocked.
/// @throws ResourceError if no thread can be started.
void note_interrupts();

/// @throws Interrupted if a signal was noted.
void check_interrupted();

}  // namespace palpate
