// Ctrl-C: a wish that long computations look at between steps.
#pragma once

namespace palpate {

/// From now on SIGINT and SIGTERM are noted instead of ending the process; a second one
/// ends it at once with exit code 130.
void note_interrupts();

/// @throws Interrupted if a signal was noted.
void check_interrupted();

}  // namespace palpate
