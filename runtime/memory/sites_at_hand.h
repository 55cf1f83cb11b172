// The memory of the sites that one element reads, at hand, and blended at a place.
//
// Corner j reads site i with the share m_ij >= 0, sum_i m_ij <= 1. At the place with
// weights w_j a site weighs m_i = sum_j w_j m_ij, and
//
//   g_k = sum_j w_j g_jk,   q_k = sum_i m_i q_ik,   s = sum_k g_k q_k.
//
// Neighbouring elements share the corners of their common edge, so that all three are
// continuous over the surface. What is at hand is newer than the table
// (surface_memory.h), where it goes back when another element comes to hand. Of a
// surface that yields (yielding_place.h),
//
//   D = sum_i m_i D_i,   m = sum_i m_i m_i,
//
// and the table always has what the sites at hand have (or more, where others write to
// it: recall_yielded()).
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/element/element.h"
#include "runtime/element/turned.h"
#include "runtime/memory/place_curve.h"
#include "runtime/memory/surface_memory.h"
#include "runtime/memory/yielding_place.h"

namespace palpate {

constexpr std::size_t kSitesAtHand = 3 * kNodeSites;  ///< that one element reads

struct SitesAtHand {
  std::size_t count = 0;
  double time_s = 0.0;  ///< [s] for when the forces hold
  std::array<std::int32_t, kSitesAtHand> site{};
  std::array<std::array<Real, 3>, kSitesAtHand> share{};  ///< [-] m_ij
  std::array<TermValues, kSitesAtHand> relaxing;  ///< [-] g_k where it goes back alone
  std::array<std::array<TermValues, kSitesAtHand>, kMemoryBundles> relaxed_n;  ///< [N]
  std::array<TermValues, 3> corner_relaxing;    ///< [-] g_jk
  bool uniform = false;                         ///< the same at all corners
  std::array<Real, kSitesAtHand> dent_m{};      ///< [m] D_i, where the tool yields
  std::array<Real, kSitesAtHand> softened_m{};  ///< [m]
  // At the place.
  std::array<Turned<Real>, kSitesAtHand> weight{};  ///< [-] m_i
  Turned<TermValues> place_relaxing{TermValues::Zero(), TermValues::Zero(),
                                    TermValues::Zero(),
                                    TermValues::Zero()};  ///< [-] g_k
};

/// The sites of an element, with what is remembered of them: at hand until now, else in
/// the table. All hold at memory.time_s.
[[nodiscard]] SitesAtHand sites_of(const Element& element, const SitesAtHand& until_now,
                                   const SurfaceMemory& memory) noexcept;

/// Takes what has yielded of the sites at hand from the table, where others write, too.
void recall_yielded(SitesAtHand& sites, const SurfaceMemory& memory) noexcept;

/// Writes what is at hand into the table.
void put_back(const SitesAtHand& sites, SurfaceMemory& memory) noexcept;

/// Lets all sites go back by themselves until memory.time_s, if they are behind.
void catch_up(SitesAtHand& sites, const SurfaceMemory& memory) noexcept;

/// Weights of sites and terms at a place. @param weight w_j >= 0.
void weigh(SitesAtHand& sites, const NodeValues& weight, const Turn& turn) noexcept;

/// Of one bundle at the place.
struct BlendedMemory {
  Turned<TermValues> relaxed_n{TermValues::Zero(), TermValues::Zero(),
                               TermValues::Zero(), TermValues::Zero()};  ///< [N] q_k
  Real carried_n = 0.0;                                                  ///< [N] s
};

/// Where the sites were weighed.
[[nodiscard]] BlendedMemory blended(const SitesAtHand& sites, int bundle) noexcept;

/// s of relaxed forces at the place [N].
[[nodiscard]] inline Real carried_n(const SitesAtHand& sites,
                                    const TermValues& relaxed_n) noexcept {
  return (sites.place_relaxing.value * relaxed_n).sum();
}

/// Derivatives of s by the place's coordinates [N].
[[nodiscard]] inline Vector3 carried_slope_n(const SitesAtHand& sites,
                                             const BlendedMemory& memory) noexcept {
  const Turned<TermValues>& g = sites.place_relaxing;
  const Turned<TermValues>& q = memory.relaxed_n;
  return {(g.value * q.by_1 + g.by_1 * q.value).sum(),
          (g.value * q.by_2 + g.by_2 * q.value).sum(),
          (g.value * q.by_3 + g.by_3 * q.value).sum()};
}

/// Sum over sites of weight times value, where they were weighed.
[[nodiscard]] Turned<Real> blended(
    const SitesAtHand& sites, const std::array<Real, kSitesAtHand>& value) noexcept;

/// Moves the blended q_k of a bundle by a share of their way to a target. The move is
/// exact, and goes through sites on this side of the target, none of which passes it.
/// Site i goes min(1, kappa m_i) of its own way, kappa one for all: at a rate that
/// grows with its weight. Sites on the other side stay.
/// @param blend    of the bundle before; after it, derivatives are those of the sites.
/// @param from_n   [N] the blended q_k before.
/// @param target_n [N] >= 0.
/// @param share    [-] [0, 1] of each term.
void move_towards(SitesAtHand& sites, int bundle, const TermValues& from_n,
                  Real target_n, const TermValues& share,
                  Turned<TermValues>& blend) noexcept;

}  // namespace palpate
