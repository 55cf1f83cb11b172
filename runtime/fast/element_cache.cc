#include "runtime/fast/element_cache.h"

namespace palpate {
namespace {

bool well_formed(const Element& element) {
  for (const ElementNode& node : element.node) {
    const bool none = node.samples == 0;
    const bool some =
        node.samples >= 2 && node.samples <= static_cast<std::int32_t>(kElementSamples);
    if (!none && !some) {
      return false;
    }
  }
  return element.triangle >= 0;
}

// Same triangle, else empty (stored_at 0), else the oldest; not the pinned one.
int slot_for(const ElementCache& cache, std::int32_t triangle) {
  int oldest = -1;
  for (int i = 0; i < kCacheSlots; ++i) {
    const auto slot = static_cast<std::size_t>(i);
    if (i == cache.pinned) {
      continue;
    }
    if (cache.stored_at[slot] > 0 && cache.triangle[slot] == triangle) {
      return i;
    }
    if (oldest < 0 ||
        cache.stored_at[slot] < cache.stored_at[static_cast<std::size_t>(oldest)]) {
      oldest = i;
    }
  }
  return oldest;
}

}  // namespace

void store(ElementCache& cache, const Element& element) noexcept {
  if (!well_formed(element)) {
    ++cache.rejected;
    return;
  }
  const int chosen = slot_for(cache, element.triangle);
  const auto slot = static_cast<std::size_t>(chosen);
  if (cache.newest_active == chosen) {
    cache.newest_active = -1;
  }
  cache.element[slot] = element;
  cache.triangle[slot] = element.triangle;
  cache.stored_at[slot] = ++cache.received;
  if (element.active) {
    cache.newest_active = chosen;
  }
}

int find(const ElementCache& cache, std::int32_t triangle) noexcept {
  int newest = -1;
  std::uint64_t stored_at = 0;
  for (int i = 0; i < kCacheSlots; ++i) {
    const auto slot = static_cast<std::size_t>(i);
    if (cache.triangle[slot] == triangle && cache.stored_at[slot] > stored_at) {
      newest = i;
      stored_at = cache.stored_at[slot];
    }
  }
  return newest;
}

}  // namespace palpate
