// The latest value from one thread to one other; older values are overwritten.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace palpate {

/// Exactly one writer thread and one reader thread, both wait-free. There are three
/// slots. The writer fills its own, the reader reads its own, and the third changes
/// hands in one atomic exchange. So a value is never seen half written.
template <typename T>
// Indices have cache lines of their own, hence padding.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding)
class TripleBuffer {
  static_assert(std::is_copy_assignable_v<T>);

 public:
  /// Writer. Replaces the value that the reader has not fetched yet.
  void write(const T& value) noexcept {
    slot_[back_] = value;
    back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kIndex;
  }

  /// Reader. Whether a value arrived since the last call; latest() then refers to it.
  [[nodiscard]] bool fetch() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) {
      return false;
    }
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return true;
  }

  /// Reader. The value last fetched; a default T before the first.
  [[nodiscard]] const T& latest() const noexcept { return slot_[front_]; }

 private:
  static constexpr std::uint32_t kIndex = 3;
  static constexpr std::uint32_t kFresh = 4;

  std::array<T, 3> slot_{};
  std::atomic<std::uint32_t> middle_{1};
  alignas(64) std::uint32_t back_ = 0;   // writer's
  alignas(64) std::uint32_t front_ = 2;  // reader's
};

}  // namespace palpate
