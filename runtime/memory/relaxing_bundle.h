// What time does to one bundle of a contact's memory (relaxation_step.h), without the
// account: the parts that one contact and several that are coupled share.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/element/element_cache.h"
#include "runtime/memory/relaxing_contact.h"
#include "runtime/memory/surface_memory.h"

namespace palpate {

[[nodiscard]] constexpr std::size_t array_index(Eigen::Index i) noexcept {
  return static_cast<std::size_t>(i);
}

/// How many times deeper than the contact a relaxed force's depth is looked for.
constexpr Real kDeepest = 8.0;

/// 1 - e^(-t / tau_k) of each term; 0 beyond the terms.
[[nodiscard]] TermValues passed_shares(const SurfaceMemory& memory,
                                       Real time_s) noexcept;

/// Where a bundle's step began.
struct BundleStart {
  bool pressed;   ///< goes towards target_n; else by itself
  bool touched;   ///< p > s
  Real depth_m;   ///< [m] l of delta(p_0)
  Real target_n;  ///< [N] p_0
  TermValues relaxed_n;
  Real carried_n;
  CurveInverse dent;
  Real energy_j;
};

/// Of the contact's latest response.
[[nodiscard]] BundleStart start_of(const RelaxingContact& contact, int bundle) noexcept;

/// The blended forces of a pressed bundle, gone this share of their way. Its dent is
/// not solved then.
void press(RelaxingContact& contact, const BundleStart& start, const TermValues& share,
           int bundle) noexcept;

/// Lets the sites of a bundle that is not touched go back. False, and nothing is
/// changed, if the surface came up to the tool meanwhile.
bool recover(RelaxingContact& contact, const SurfaceMemory& memory, int bundle,
             Real time_s) noexcept;

/// Back to where the step of a pressed bundle began.
void undo(BundleContact& bundle, const BundleStart& start) noexcept;

/// (delta(p_0) - delta(q_k)) times what q_k has gone, of each term [J]. Times
/// g_k (1 - share) it is what the bundle loses of its energy in the step, to first
/// order. delta(q_k) is that last found.
[[nodiscard]] TermValues way_down(const RelaxingContact& contact,
                                  const BundleStart& start, int bundle) noexcept;

/// Writes a bundle's step to the sites.
void write_step(RelaxingContact& contact, const BundleStart& start,
                const TermValues& share, int bundle) noexcept;

/// V of a bundle, its relaxed forces' depths brought up to date [J] >= 0.
[[nodiscard]] double dent_j(RelaxingContact& contact, const SurfaceMemory& memory,
                            const ElementCache& cache, int bundle) noexcept;

}  // namespace palpate
