// The latest elements that the slow process has sent.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "runtime/element/element.h"

namespace palpate {

constexpr int kCacheSlots = 32;

/// A fixed number of elements, newest copy of each triangle first to be found. A slot
/// in use by the local model (`pinned`) is never written.
struct ElementCache {
  std::array<Element, kCacheSlots> element;
  std::uint64_t received = 0;  ///< elements stored since the start
  std::uint64_t rejected = 0;  ///< elements refused: malformed
  std::array<std::int32_t, kCacheSlots> triangle{};    ///< of the slot, once it is used
  std::array<std::uint64_t, kCacheSlots> stored_at{};  ///< `received` then; 0: empty
  int pinned = -1;         ///< slot that the local model reads; -1: none
  int newest_active = -1;  ///< slot of the latest element sent as active; -1: none
};

[[nodiscard]] inline const Element& element_of(const ElementCache& cache,
                                               int slot) noexcept {
  return cache.element[static_cast<std::size_t>(slot)];
}

[[nodiscard]] inline std::int32_t triangle_in(const ElementCache& cache,
                                              int slot) noexcept {
  return cache.triangle[static_cast<std::size_t>(slot)];
}

/// Whether counts and values are in the ranges that element.h states.
[[nodiscard]] bool well_formed(const ElementMemory& memory) noexcept;
[[nodiscard]] bool well_formed(const NodePuncture& node) noexcept;

/// Stores a copy. The slot is that of the same triangle, else an empty one, else the
/// oldest; never the pinned one. Refuses an element without triangle, with a sample
/// count outside [0, kElementSamples] or of 1, or with a memory out of its ranges
/// (element.h). @returns whether it was stored.
bool store(ElementCache& cache, const Element& element) noexcept;

/// Slot of the newest copy of a triangle; -1 if it is not there.
[[nodiscard]] int find(const ElementCache& cache, std::int32_t triangle) noexcept;

}  // namespace palpate
