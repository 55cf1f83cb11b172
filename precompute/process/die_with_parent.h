// A forked child: it does not outlive its parent, which waits for it.
#pragma once

#include <sys/types.h>

namespace palpate {

/// In a child, at once after the fork: it is killed when the thread that forked it
/// ends. Ends it here and now where that has happened already.
/// @param parent getpid() before the fork.
void die_with_parent(pid_t parent) noexcept;

/// Waits until a child has ended, whatever signals arrive meanwhile.
/// @return its status, as waitpid() has it.
int wait_for_child(pid_t child) noexcept;

}  // namespace palpate
