// What this process has needed so far.
#pragma once

#include <cstdint>

namespace palpate {

/// Largest resident set so far [bytes].
[[nodiscard]] std::int64_t peak_memory_bytes();

}  // namespace palpate
