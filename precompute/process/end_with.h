// A service that another program started: it does not outlive it.
#pragma once

#include <sys/types.h>

namespace palpate {

/// From now on this process gets a SIGTERM as soon as the given process has ended,
/// whichever of that process's threads began this one. If the given process has ended
/// already, the signal comes at once. Nothing happens on systems that cannot tell
/// (Linux before 5.3). Call it after note_interrupts(): it makes a thread.
void end_with(pid_t process);

}  // namespace palpate
