// Ctrl-C: a wish that long computations look at between steps.
#pragma once

namespace palpate {

/// From now on SIGINT and SIGTERM are noted, by a thread that waits for them, instead
/// of ending the process; a second one ends it at once with exit code 130. To be called
/// before this process has other threads: they take over that the signals are blocked.
/// @throws ResourceError if no thread can be started.
void note_interrupts();

/// @throws Interrupted if a signal was noted.
void check_interrupted();

}  // namespace palpate
