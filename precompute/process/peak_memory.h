// What this process has needed so far.
#pragma once

#include <cstdint>

namespace palpate {

/// Largest resident set so far [bytes], or since restart_peak_memory().
[[nodiscard]] std::int64_t peak_memory_bytes();

/// Gives free memory back and counts the peak from here on. Where the system does not
/// allow that, the peak stays that of the whole process.
void restart_peak_memory();

/// Processor time of all threads so far [s].
[[nodiscard]] double cpu_seconds();

}  // namespace palpate
