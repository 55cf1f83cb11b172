#include "runtime/memory/yielded_sites.h"

#include <algorithm>
#include <cstddef>

namespace palpate {
namespace {

// Rows that a site may have: so many steps does looking one up take at most.
constexpr int kReach = std::min(64, kYieldedSites);

// The row of the site, or the free one that it would get; -1 if there is neither.
int place_of(const YieldedSites& sites, std::int32_t site) {
  int row = site % kYieldedSites;
  for (int step = 0; step < kReach; ++step) {
    const std::int32_t there = sites.row[static_cast<std::size_t>(row)].site;
    if (there == site || there < 0) {
      return row;
    }
    row = row + 1 < kYieldedSites ? row + 1 : 0;
  }
  return -1;
}

}  // namespace

int find_yielded(const YieldedSites& sites, std::int32_t site) noexcept {
  const int row = place_of(sites, site);
  return row >= 0 && sites.row[static_cast<std::size_t>(row)].site == site ? row : -1;
}

int claim_yielded(YieldedSites& sites, std::int32_t site) noexcept {
  const int row = place_of(sites, site);
  if (row < 0) {
    ++sites.refused;
    return -1;
  }
  YieldedSite& there = sites.row[static_cast<std::size_t>(row)];
  if (there.site < 0) {
    there.site = site;
    ++sites.count;
  }
  return row;
}

}  // namespace palpate
