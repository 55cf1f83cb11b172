// A wish to end, from Ctrl-C, a closed terminal or a system that shuts down.
#pragma once

#include <atomic>

namespace palpate {

/// From now on SIGINT, SIGTERM and SIGHUP set what is returned instead of ending the
/// process.
[[nodiscard]] const std::atomic<bool>& stop_signals();

/// As a signal would, from within: sets what stop_signals() returns.
void request_stop() noexcept;

/// From now on they end the process again.
void release_stop_signals();

}  // namespace palpate
