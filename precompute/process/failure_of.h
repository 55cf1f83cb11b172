// Work whose faults are its own: an exception becomes a sentence.
#pragma once

#include <functional>
#include <string>

namespace palpate {

/// Does the work. @return why it could not be done, from what it threw; empty where it
/// could. @param whose "its press", for exceptions that say nothing.
/// @throws Interrupted and ResourceError (also for std::bad_alloc), which are not its
/// faults.
[[nodiscard]] std::string failure_of(const std::string& whose,
                                     const std::function<void()>& work);

}  // namespace palpate
