#include "runtime/memory/surface_memory.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace palpate {
namespace {

// First row of a site's set, of those sets whose rows have forces.
int first_row(const SurfaceMemory& memory, std::int32_t site) {
  const int rows = std::min<int>(kMemorySites, kMemoryBundleRows / memory.bundles);
  return (site % (rows / kMemoryWays)) * kMemoryWays;
}

std::int32_t site_in(const SurfaceMemory& memory, int row) {
  return memory.row[static_cast<std::size_t>(row)].site;
}

Real largest_force(const SurfaceMemory& memory, int row) {
  Real largest = 0.0;
  for (int b = 0; b < memory.bundles; ++b) {
    largest = std::max(largest, relaxed_forces(memory, row, b).maxCoeff());
  }
  return largest;
}

}  // namespace

bool agrees(const SurfaceMemory& memory, const ElementMemory& element) noexcept {
  return memory.times.terms == element.terms && memory.bundles == element.bundles &&
         std::equal(element.relaxation_s.begin(),
                    element.relaxation_s.begin() + element.terms,
                    memory.times.tau_s.data());
}

void take_terms(SurfaceMemory& memory, const ElementMemory& element) noexcept {
  memory.yields = memory.yields || element.yields;
  if (memory.times.terms > 0 || element.terms == 0) {
    return;
  }
  memory.times.terms = element.terms;
  memory.bundles = element.bundles;
  for (std::int32_t k = 0; k < element.terms; ++k) {
    const Real tau = element.relaxation_s[static_cast<std::size_t>(k)];
    memory.times.tau_s(k) = tau;
    memory.times.rate_hz(k) = Real(1.0) / tau;
  }
}

int find_site(const SurfaceMemory& memory, std::int32_t site) noexcept {
  const int first = first_row(memory, site);
  for (int row = first; row < first + kMemoryWays; ++row) {
    if (site_in(memory, row) == site) {
      return row;
    }
  }
  return -1;
}

int claim_site(SurfaceMemory& memory, std::int32_t site) noexcept {
  const int found = find_site(memory, site);
  if (found >= 0) {
    return found;
  }
  const int first = first_row(memory, site);
  int chosen = first;
  Real least = std::numeric_limits<Real>::infinity();
  for (int row = first; row < first + kMemoryWays; ++row) {
    const bool free = site_in(memory, row) < 0;
    const Real kept = free ? Real(-1.0) : largest_force(memory, row);
    if (kept < least) {
      chosen = row;
      least = kept;
    }
  }
  memory.forgotten += least > 0.0 ? 1 : 0;
  for (int b = 0; b < memory.bundles; ++b) {
    relaxed_forces(memory, chosen, b).setZero();
  }
  memory.row[static_cast<std::size_t>(chosen)] = {.site = site,
                                                  .time_s = memory.time_s};
  return chosen;
}

TermValues recovered(const SurfaceMemory& memory, const TermValues& relaxed_n,
                     const TermValues& relaxing, Real time_s) noexcept {
  const TermValues q = recovered_freely(memory.times, relaxed_n, relaxing, time_s);
  return q.maxCoeff() < kForgottenN ? TermValues(TermValues::Zero()) : q;
}

Real carried_n(const SurfaceMemory& memory, int row) noexcept {
  const MemorySite& site = memory.row[static_cast<std::size_t>(row)];
  Real carried = 0.0;
  for (int b = 0; b < memory.bundles && site.site >= 0; ++b) {
    carried += (site.relaxing *
                recovered(memory, relaxed_forces(memory, row, b), site.relaxing,
                          static_cast<Real>(memory.time_s - site.time_s)))
                   .sum();
  }
  return carried;
}

void forget_all(SurfaceMemory& memory) noexcept {
  memory.row.fill({});
  memory.relaxed_n.fill(TermValues::Zero());
}

}  // namespace palpate
