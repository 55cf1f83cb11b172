// What a body's surface remembers of being pressed: relaxed forces at sites.
//
// A site is a place of the surface, known by its number in the database. Its memory
// outlives the elements that read it. Only touched sites take a row here. The rows of a
// site lie in one of several sets by its number, so finding a row is bounded work. A
// body with no more sites than rows never loses a site. When a set is full, the site
// that remembers least makes room: its dent is forgotten while nobody touches it.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/element/element.h"
#include "runtime/memory/free_recovery.h"
#include "runtime/memory/yielded_sites.h"

// Rows of the table, a multiple of kMemoryWays; fewer for small processors.
#ifndef PALPATE_MEMORY_SITES
#define PALPATE_MEMORY_SITES 1024
#endif

namespace palpate {

constexpr int kMemoryWays = 8;  ///< rows of a set
constexpr int kMemorySites = PALPATE_MEMORY_SITES;
/// Bundles that the table holds: with more than two of a site it has fewer rows.
constexpr int kMemoryBundleRows = 2 * kMemorySites;
static_assert(kMemorySites % kMemoryWays == 0);
static_assert(kMemoryBundleRows >= kMemoryWays * static_cast<int>(kMemoryBundles));

/// Relaxed force below which an untouched site is forgotten [N].
constexpr Real kForgottenN = 1e-6;

struct MemorySite {
  std::int32_t site = -1;                    ///< number in the database; -1: free row
  double time_s = 0.0;                       ///< [s] for when its forces hold
  TermValues relaxing = TermValues::Zero();  ///< [-] g_k of the elements that read it
};

struct SurfaceMemory {
  double time_s = 0.0;    ///< [s] since the start, as the steps counted it, but for ...
  Real gathered_s = 0.0;  ///< [s] ... what has passed and is not spent yet
  RelaxationTimes times;  ///< of the tool; no terms: nothing is remembered
  std::int32_t bundles = 1;  ///< of the tool
  std::array<MemorySite, kMemorySites> row;
  std::array<TermValues, kMemoryBundleRows> relaxed_n;  ///< [N] q_k by row and bundle
  std::uint64_t forgotten = 0;  ///< dents that gave way to others
  std::uint64_t shortened = 0;  ///< steps cut because the account was short
  double shortened_j = 0.0;     ///< [J] >= 0 by which they would have exceeded it
  bool yields = false;          ///< the tool's responses leave dents or soften
  YieldedSites yielded;         ///< what stays of that
  /// Where that lies instead, of contacts that share it; it outlives this. Null: here.
  YieldedSites* shared = nullptr;
};

[[nodiscard]] inline YieldedSites& yielded_of(SurfaceMemory& memory) noexcept {
  return memory.shared != nullptr ? *memory.shared : memory.yielded;
}

[[nodiscard]] inline const YieldedSites& yielded_of(
    const SurfaceMemory& memory) noexcept {
  return memory.shared != nullptr ? *memory.shared : memory.yielded;
}

/// Whether anything stays of a press, for a while or for good.
[[nodiscard]] inline bool remembers(const SurfaceMemory& memory) noexcept {
  return memory.times.terms > 0 || memory.yields;
}

/// Whether an element's terms, times and bundles are those of the memory; no others are
/// read.
[[nodiscard]] bool agrees(const SurfaceMemory& memory,
                          const ElementMemory& element) noexcept;

/// Takes terms, times and bundles from a tool's first element that has some, and
/// whether the tool yields from any.
void take_terms(SurfaceMemory& memory, const ElementMemory& element) noexcept;

/// Row of a site; -1 if nothing is remembered of it.
[[nodiscard]] int find_site(const SurfaceMemory& memory, std::int32_t site) noexcept;

/// Row of a site, made if there is none: free, or that of the site in its set that
/// remembers least.
int claim_site(SurfaceMemory& memory, std::int32_t site) noexcept;

/// Where relaxed_n has a row's bundle.
[[nodiscard]] inline std::size_t relaxed_place(const SurfaceMemory& memory, int row,
                                               int bundle) noexcept {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(memory.bundles) +
         static_cast<std::size_t>(bundle);
}

/// q_k of a row and bundle [N].
[[nodiscard]] inline TermValues& relaxed_forces(SurfaceMemory& memory, int row,
                                                int bundle) noexcept {
  return memory.relaxed_n[relaxed_place(memory, row, bundle)];
}

[[nodiscard]] inline const TermValues& relaxed_forces(const SurfaceMemory& memory,
                                                      int row, int bundle) noexcept {
  return memory.relaxed_n[relaxed_place(memory, row, bundle)];
}

/// What a place's relaxed forces become in a time that nobody touches it; forgotten
/// where all are below kForgottenN. @param relaxing (K) [-] g_k of the place.
[[nodiscard]] TermValues recovered(const SurfaceMemory& memory,
                                   const TermValues& relaxed_n,
                                   const TermValues& relaxing, Real time_s) noexcept;

/// s of a row at memory.time_s [N], of all bundles; 0 for a free row.
[[nodiscard]] Real carried_n(const SurfaceMemory& memory, int row) noexcept;

/// Everything that goes back by itself is gone; counts, time and what has yielded stay.
void forget_all(SurfaceMemory& memory) noexcept;

}  // namespace palpate
