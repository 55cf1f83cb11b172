// What of being pressed stays for good, at sites of the surface (surface_memory.h).
//
// Values only grow, and a site that has a row keeps it: nothing is forgotten while the
// tool is there, and nothing after. Where no row is free any more a new site gets none:
// it stays as it is, which creates no energy (yield_step.h).
#pragma once

#include <array>
#include <cstdint>

#include "runtime/account/real.h"

// Rows of the table; fewer for small processors.
#ifndef PALPATE_YIELDED_SITES
#ifdef PALPATE_MEMORY_SITES
#define PALPATE_YIELDED_SITES PALPATE_MEMORY_SITES
#else
#define PALPATE_YIELDED_SITES 4096
#endif
#endif

namespace palpate {

constexpr int kYieldedSites = PALPATE_YIELDED_SITES;

struct YieldedSite {
  std::int32_t site = -1;  ///< number in the database; -1: free row
  Real dent_m = 0.0;       ///< [m] >= 0 D of it, along the surface's normal
  Real softened_m = 0.0;   ///< [m] >= 0 m: depth up to which its curve has softened
};

/// A site lies in the row of its number, or in one of the next that was free then.
struct YieldedSites {
  std::array<YieldedSite, kYieldedSites> row;
  std::int32_t count = 0;     ///< rows that are taken
  std::uint64_t refused = 0;  ///< times that a site got no row
};

/// Row of a site; -1 if nothing has stayed there.
[[nodiscard]] int find_yielded(const YieldedSites& sites, std::int32_t site) noexcept;

/// Row of a site, taken if it has none. @returns -1 where none of those that it may
/// have is free; counted.
int claim_yielded(YieldedSites& sites, std::int32_t site) noexcept;

}  // namespace palpate
