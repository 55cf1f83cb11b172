// What a board measures of the code between two calls; nothing on the host.
#pragma once

#include <cstdint>

namespace palpate::board {

#ifdef __arm__
void count_begin() noexcept;

/// Instructions since count_begin(), under QEMU's -icount shift=10; < 600,000.
[[nodiscard]] std::uint32_t count_end() noexcept;

/// Most of the stack that was ever in use between the two calls [bytes].
[[nodiscard]] std::uint32_t stack_used() noexcept;
#else
inline void count_begin() noexcept {}
inline std::uint32_t count_end() noexcept {
  return 0;
}
inline std::uint32_t stack_used() noexcept {
  return 0;
}
#endif

}  // namespace palpate::board
