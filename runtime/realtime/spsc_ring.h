// A fixed queue from one thread to one other; nobody waits, nobody allocates.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace palpate {

/// First in, first out, for exactly one producer thread and one consumer thread. When
/// it is full, the new value is dropped and counted: the consumer is late, and what it
/// holds is still in order. Wait-free on both sides.
template <typename T, std::size_t kCapacity>
class SpscRing {
  static_assert(std::has_single_bit(kCapacity),
                "a power of two: positions wrap by mask");
  static_assert(std::is_trivially_copyable_v<T>, "values cross threads as bytes");

 public:
  /// Producer. False if full: the value is dropped and counted.
  [[nodiscard]] bool push(const T& value) noexcept {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (tail - head_.load(std::memory_order_acquire) == kCapacity) {
      dropped_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    slot_[tail & kMask] = value;
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  /// Consumer. The oldest value, in place until pop(); null if there is none.
  [[nodiscard]] const T* front() const noexcept {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    return head == tail_.load(std::memory_order_acquire) ? nullptr
                                                         : &slot_[head & kMask];
  }

  /// Consumer. Gives the oldest value's slot back; only after front() was not null.
  void pop() noexcept {
    head_.store(head_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// Any thread. Values dropped since the start.
  [[nodiscard]] std::uint64_t dropped() const noexcept {
    return dropped_.load(std::memory_order_relaxed);
  }

 private:
  static constexpr std::uint64_t kMask = kCapacity - 1;
  static constexpr std::size_t kCacheLine = 64;  // apart, or each side slows the other

  std::array<T, kCapacity> slot_{};
  alignas(kCacheLine) std::atomic<std::uint64_t> head_{0};  // next to read
  alignas(kCacheLine) std::atomic<std::uint64_t> tail_{0};  // next to write
  alignas(kCacheLine) std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace palpate
