// Waiting for memory, processes and room on disks that are wanting at present.
#pragma once

#include <functional>
#include <string>

namespace palpate {

/// [s] What is waited for in the middle of other work, which keeps its memory
/// meanwhile.
inline constexpr double kMomentS = 20.0;

/// Does the work. While the work throws ResourceError or std::bad_alloc, it is repeated
/// with pauses of up to five seconds, until patience_s after the first time.
/// @param whose "its press", for the message of a bad_alloc.
/// @throws ResourceError if the work still fails so; Interrupted; what else the work
/// throws.
void with_patience(double patience_s, const std::string& whose,
                   const std::function<void()>& work);

}  // namespace palpate
