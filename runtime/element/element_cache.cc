#include "runtime/element/element_cache.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>

namespace palpate {
namespace {

// What sums of shares may exceed one by.
constexpr Real kShareRounding = rounding(1e-6, 1e-5);

bool is_share(std::span<const Real> values) {
  const bool positive = std::all_of(values.begin(), values.end(), [](Real value) {
    return value >= 0.0;
  });
  return positive && std::accumulate(values.begin(), values.end(), Real(0.0)) <=
                         1.0 + kShareRounding;
}

bool is_depth(Real value) {
  return value >= 0.0 && std::isfinite(value);
}

bool yields_well(const NodeMemory& node) {
  return is_depth(node.yield_depth_m) && is_depth(node.onset_m) &&
         is_depth(node.soft_scale_m) && node.soft_scale_m > 0.0 &&
         node.dent_share >= 0.0 && node.dent_share < 1.0 && node.soft_most >= 0.0 &&
         node.soft_most < 1.0;
}

bool well_formed(const Element& element) {
  for (const ElementNode& node : element.node) {
    const bool none = node.samples == 0;
    const bool some =
        node.samples >= 2 && node.samples <= static_cast<std::int32_t>(kElementSamples);
    if (!none && !some) {
      return false;
    }
  }
  return element.triangle >= 0 && well_formed(element.memory) &&
         std::all_of(element.puncture.begin(), element.puncture.end(),
                     [](const NodePuncture& node) {
                       return well_formed(node);
                     });
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

bool well_formed(const NodePuncture& node) noexcept {
  if (node.layers < 0 || node.layers > static_cast<std::int32_t>(kPunctureLayers) ||
      !(node.rupture >= 0.0)) {
    return false;
  }
  for (std::size_t k = 0; k < static_cast<std::size_t>(node.layers); ++k) {
    const bool begins =
        k == 0 ? node.depth_m[0] == 0.0 : node.depth_m[k] > node.depth_m[k - 1];
    if (!begins || !std::isfinite(node.depth_m[k]) || node.material[k] < 0 ||
        node.material[k] >= kPunctureMaterials) {
      return false;
    }
  }
  return true;
}

bool well_formed(const ElementMemory& memory) noexcept {
  const auto most_terms = static_cast<std::int32_t>(kMemoryTerms);
  const auto most_bundles = static_cast<std::int32_t>(kMemoryBundles);
  if (memory.terms == 0 && !memory.yields) {
    return true;
  }
  if (memory.terms < 0 || memory.terms > most_terms || memory.bundles < 1 ||
      memory.bundles > most_bundles) {
    return false;
  }
  // Relaxation times are positive, finite and strictly increasing: free_recovery.h
  // looks for one root between two of them.
  const auto tau =
      std::span(memory.relaxation_s).first(static_cast<std::size_t>(memory.terms));
  const bool rises = std::adjacent_find(tau.begin(), tau.end(), [](Real a, Real b) {
                       return !(a < b);
                     }) == tau.end();
  const bool lasts =
      tau.empty() || (tau.front() > 0.0 && rises && std::isfinite(tau.back()));
  // Cuts do not decrease, for bundle b reaches from cut b - 1 to cut b.
  return lasts &&
         std::all_of(memory.node.begin(), memory.node.end(),
                     [&](const NodeMemory& node) {
                       return is_share(node.weight) && is_share(node.relaxing) &&
                              yields_well(node) &&
                              std::is_sorted(node.cut_m.begin(),
                                             node.cut_m.begin() + memory.bundles - 1);
                     });
}

bool store(ElementCache& cache, const Element& element) noexcept {
  if (!well_formed(element)) {
    ++cache.rejected;
    return false;
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
  return true;
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
