// A forked child that does not outlive its parent.
#pragma once

#include <sys/types.h>

namespace palpate {

/// In a child, at once after the fork: it is killed when the thread that forked it
/// ends. Ends it here and now where that has happened already.
/// @param parent getpid() before the fork.
void die_with_parent(pid_t parent) noexcept;

}  // namespace palpate
