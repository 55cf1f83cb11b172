// A contact with a surface that remembers: quasi-linear viscoelasticity (Fung) whose
// history lies at sites of the surface, rendered without creating energy.
//
// p(y) is the instantaneous response at the contact's place (place_curve.h), U its
// energy, delta(q) its inverse, U* = q delta(q) - U(delta(q)) its conjugate. Relaxed
// forces q_k >= 0 carry s = sum g_k q_k, blended from the sites (sites_at_hand.h). The
// surface keeps a dent of depth delta(s):
//
//   F_n = max(0, p(y) - s),     q_k' = (max(p(y), s) - q_k) / tau_k.
//
// In contact that is the convolution of p with 1 - sum g_k (1 - exp(-t / tau_k)).
// Without, the surface bears no force and goes back by itself (free_recovery.h); to be
// touched again before it has needs no case. What is rendered is one potential of the
// tool's place at frozen q, the Bregman distance of U from the dent,
//
//   u = U(y) - U(delta(s)) - s (y - delta(s)) for p(y) > s, else 0;     F = -grad u.
//
// A curve that is cut into bundles (place_curve.h) has all of this for each of them.
// Here is the response at frozen memory; relaxation_step.h lets time pass.
//
// Where the surface yields (yielding_place.h), p and U are those of the elastic
// response at the depth e = y - D. There depths of the curve are l, and distances and
// energies are taken in e. yield_step.h raises what has yielded.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/element/element_cache.h"
#include "runtime/memory/place_curve.h"
#include "runtime/memory/sites_at_hand.h"
#include "runtime/memory/surface_memory.h"
#include "runtime/memory/yielding_place.h"

namespace palpate {

/// One bundle's memory where the contact is.
struct BundleContact {
  BlendedMemory memory;
  PlacePoint at;         ///< at the contact's depth
  PlacePoint at_yield;   ///< at Y, where the surface yields
  CurveInverse dent;     ///< delta(s), as a depth of the curve; else near it
  bool solved = false;   ///< dent is that of s
  bool touched = false;  ///< p > s
  Real energy_j = 0.0;   ///< [J] u
  PlaceCubic near_dent;
  TermValues relaxed_depth_m = TermValues::Zero();  ///< [m] near delta(q_k)
  std::array<PlaceCubic, kMemoryTerms> near_term;
  // The nodes' pieces last used at the contact, at the dent, at relaxed forces.
  NodePieces contact_pieces;
  NodePieces dent_pieces;
  NodePieces term_pieces;
  NodePieces yield_pieces;

  [[nodiscard]] bool is_marked() const noexcept {
    return (memory.relaxed_n.value > 0.0).any();
  }
};

/// What an element's memory is at a place, and the response there. Without memory
/// (`remembers` false) nothing of it is used.
struct RelaxingContact {
  bool remembers = false;
  std::int32_t slot = -1;       ///< element in the cache that was entered
  std::uint64_t stored_at = 0;  ///< which element that was
  PlaceNodes nodes;
  YieldingNodes yielding;
  SitesAtHand sites;
  NodeValues place_weight = NodeValues::Zero();  ///< [-] w_j of the place
  Turn place_turn = Turn::Zero();
  NodeValues weight = NodeValues::Zero();  ///< [-] w_j (1 - omega_j)
  Turn turn = Turn::Zero();                ///< its derivatives
  YieldingPlace yielded;
  Real tool_m = 0.0;   ///< [m] y of the latest response
  Real depth_m = 0.0;  ///< [m] l of it: y where nothing yields
  std::array<BundleContact, kMemoryBundles> bundle;
  std::uint32_t steps = 0;  ///< of relaxation
};

/// The curve where the memory was read.
[[nodiscard]] inline PlaceCurve curve_of(const RelaxingContact& contact,
                                         const ElementCache& cache) noexcept {
  return {cache.element[static_cast<std::size_t>(contact.slot)], contact.nodes,
          contact.weight};
}

/// Whether the element in `slot` is the one that was entered.
[[nodiscard]] inline bool is_in(const RelaxingContact& contact,
                                const ElementCache& cache, int slot) noexcept {
  return contact.slot == slot &&
         contact.stored_at == cache.stored_at[static_cast<std::size_t>(slot)];
}

/// Prepares what is the same all over an element, its sites at hand. One without
/// memory, or with other terms than the surface's, has no sites. What was at hand is
/// lost but for the sites of both: who keeps the contact puts it back before.
void enter(RelaxingContact& contact, const SurfaceMemory& memory,
           const ElementCache& cache, int slot, const PlaceNodes& nodes) noexcept;

/// Reads the memory at a place of the element that was entered, at memory.time_s.
void read_memory(RelaxingContact& contact, const SurfaceMemory& memory,
                 const NodeValues& weight, const Turn& turn) noexcept;

/// Reads what the sites at hand have yielded, where the memory was read.
void read_yielded(RelaxingContact& contact) noexcept;

/// What of a contact fixes its continuation at frozen memory. Of the arrays, as many
/// values are set as there are bundles.
struct CarriedMemory {
  std::int32_t bundles = 0;                    ///< 0: nothing is remembered
  std::array<Real, kMemoryBundles> carried_n;  ///< [N] s
  std::array<Real, kMemoryBundles> dent_m;     ///< [m] near delta(s)
  NodeValues weight = NodeValues::Zero();      ///< [-] w_j (1 - omega_j)
  YieldingPlace yielded;
};

[[nodiscard]] CarriedMemory carried_memory(const RelaxingContact& contact) noexcept;

/// The contact again, at the same place of the element that was entered.
void continue_at(RelaxingContact& contact, const CarriedMemory& carried) noexcept;

/// What the surface gives less than it would to a sudden press [N]: s of all bundles
/// where the memory was read.
[[nodiscard]] Real carried_n(const RelaxingContact& contact) noexcept;

/// The potential u along the normal.
struct RelaxedResponse {
  Real force_n = 0.0;            ///< [N] du/dy
  Real stiffness_n_per_m = 0.0;  ///< [N/m] d2u/dy2
  Real energy_j = 0.0;           ///< [J] u
  bool touched = false;          ///< p > s in some bundle
  bool extrapolated = false;     ///< some node beyond its curve
};

/// The response at depth y [m] where the memory was read.
[[nodiscard]] RelaxedResponse respond(RelaxingContact& contact,
                                      const ElementCache& cache, Real y_m) noexcept;

/// The same once more after the memory has changed.
[[nodiscard]] RelaxedResponse response_of(RelaxingContact& contact,
                                          const ElementCache& cache) noexcept;

/// Whether some bundle was in the latest response.
[[nodiscard]] inline bool is_touched(const RelaxingContact& contact) noexcept {
  return std::any_of(contact.bundle.begin(),
                     contact.bundle.begin() + contact.nodes.bundles,
                     [](const BundleContact& b) {
                       return b.touched;
                     });
}

/// du by the place's coordinates [J] of the latest response, y held.
[[nodiscard]] Vector3 surface_slope_j(RelaxingContact& contact,
                                      const ElementCache& cache) noexcept;

/// U_e of a bundle at the depth e of l, whose energy by the curve is known [J].
[[nodiscard]] inline Real elastic_j(const RelaxingContact& contact,
                                    const BundleContact& bundle, Real l_m,
                                    Real energy_j) noexcept {
  const Real r = contact.yielded.share_at(l_m);
  return r > 0.0 ? r * bundle.at_yield.energy_j + (Real(1.0) - r) * energy_j : energy_j;
}

/// u of one bundle at the contact's depth, for its present s [J].
inline Real set_energy(RelaxingContact& contact, const ElementCache& cache,
                       int bundle) noexcept {
  BundleContact& b = contact.bundle[static_cast<std::size_t>(bundle)];
  const Real s = b.memory.carried_n;
  b.touched = b.at.force_n > s;
  b.energy_j = 0.0;
  if (b.touched) {
    if (!b.solved) {
      b.dent = inverse(curve_of(contact, cache), bundle, s, b.dent.depth_m,
                       contact.depth_m, b.near_dent, b.dent_pieces);
      b.solved = true;
    }
    const YieldingPlace& yielded = contact.yielded;
    const Real above = yielded.elastic_depth_m(contact.depth_m) -
                       yielded.elastic_depth_m(b.dent.depth_m);
    b.energy_j =
        std::max(Real(0.0), elastic_j(contact, b, contact.depth_m, b.at.energy_j) -
                                elastic_j(contact, b, b.dent.depth_m, b.dent.energy_j) -
                                s * above);
  }
  return b.energy_j;
}

/// Whether a tool at a depth without delta_0 [m] is over the surface as it was before
/// it was ever pressed. There the tool feels nothing of the surface's memory.
[[nodiscard]] inline bool is_above(const RelaxingContact& contact,
                                   Real depth_m) noexcept {
  const auto& touch_m = contact.nodes.touch_m;
  return contact.sites.count == 0 ||
         !(depth_m > std::min({touch_m[0], touch_m[1], touch_m[2]}));
}

/// Whether a tool at depth y [m] would be past the dent where the memory was read.
[[nodiscard]] bool touches(const RelaxingContact& contact, const ElementCache& cache,
                           Real y_m) noexcept;

}  // namespace palpate
