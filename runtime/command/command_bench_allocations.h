#pragma once

#include <cstdint>

namespace palpate {

/// Calls of operator new in this thread so far. The tool's own operator new counts
/// them, for `bench step` and runtime_bench; the tests count malloc as well.
[[nodiscard]] std::uint64_t allocations_so_far();

}  // namespace palpate
