// Loops side by side that end whole or by an exception.
#pragma once

#include <cstddef>
#include <functional>

namespace palpate {

/// Calls body(0) ... body(count - 1), on all workers, in no order. Returns once all are
/// done; an exception of one is thrown after those under way have ended. Other loops'
/// exceptions do not cut this one short, as they would a plain tbb::parallel_for inside
/// them, which then returns as if it had done everything.
void in_parallel(std::size_t count, const std::function<void(std::size_t)>& body);

}  // namespace palpate
