// A build in a process of its own, so that a library that crashes on one node does not
// take the others with it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace palpate {

/// Called by whoever begins and ends a node's press in this thread; -1: none. What a
/// crash (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) finds here is left out next time.
void note_pressed_vertex(std::int32_t vertex);

/// Whether an earlier process of this build crashed while it pressed the vertex, and
/// the signal that it died of; 0: no.
[[nodiscard]] int signal_of_crash_at(std::int32_t vertex);

/// Runs work(resume) in a child process and returns its exit code; `resume` is true
/// after a crash. A child that crashes while it presses a vertex is followed by another
/// that leaves that vertex out (signal_of_crash_at), up to 100 times. SIGINT and
/// SIGTERM are handed on to the child; it dies with its parent. To be called before
/// this process has threads of its own.
/// @param how_to_go_on what the user may do after a kill, for the message.
/// @throws ResourceError where the child was killed, NumericalError where it crashed
/// elsewhere.
[[nodiscard]] int run_supervised(const std::function<int(bool resume)>& work,
                                 const std::string& how_to_go_on = "--resume");

}  // namespace palpate
