// A service that another program started: it does not outlive it.
#pragma once

#include <sys/types.h>

namespace palpate {

/// From now on this process gets a SIGTERM as soon as that one has ended, whichever of
/// its threads began this one; at once where it has. Nothing happens on systems that
/// cannot tell (Linux before 5.3). After note_interrupts(): it makes a thread.
void end_with(pid_t process);

}  // namespace palpate
