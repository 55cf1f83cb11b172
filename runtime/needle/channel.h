// A needle's channel: what a puncture leaves in a body, and what it does to the needle.
//
// The channel has an entry x_0, an axis a (unit, outward), and a depth L >= 0 that only
// grows. z = a . (x_0 - x) is the depth of the tip along the axis. The tissue before
// the tip answers as the surface did before the puncture, at the depth e = z - L. So
// the field is asked at the tip's image x_0 - a e, and knows nothing of the channel.
//
//   U = E(e) + k_b zeta^2 / 2 + K |y|^2 / 2,    K = k' l,    l = min(z, L)
//
// zeta is what the needle has stretched the tissue along its shaft, y across it.
//
// Proof that nothing of it creates energy:
// - A tick moves the tip at frozen L, l and limits. Its work is the change of U.
// - L grows at a fixed tip: dU = -f dL <= 0. J dA = F_c dL of it makes the crack, F_c
//   the cutting force. The rest is released, and lost.
// - A membrane breaks at a force f or at an energy E. Either says only when L may grow:
//   at the break itself z, L and zeta stand still, and U with them.
// - zeta is cut to what the shaft bears: U falls. l grows: y shrinks so that K y stays,
//   and U falls; l shrinks: K falls with it.
// Each part is dissipated, none is paid for.
//
// Energy view: Mahvash and Hayward 2001; Azar and Hayward 2008 (REFERENCES.md).
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/element/element.h"

namespace palpate {

constexpr int kChannels = 16;  ///< that a body keeps, at most

/// What a needle meets in one material.
struct PunctureMaterial {
  Real membrane_n = 0.0;  ///< [N] >= 0 that breaks its boundary; infinite: none does
  Real cutting_n = 0.0;   ///< [N] >= 0 F_c = J w, toughness times width of the edge
  Real friction_n_per_m = 0.0;  ///< [N/m] >= 0 of the shaft, kinetic, per length
  Real static_ratio = 1.0;      ///< [-] >= 1 static over kinetic friction
  /// [J] of the tissue before the tip that breaks its boundary, instead of membrane_n;
  /// negative: membrane_n does.
  Real membrane_j = -1.0;
};

/// What a tool punctures, and how its shaft is held.
struct PunctureRules {
  std::int32_t materials = 0;  ///< [0, kPunctureMaterials]; 0: the tool is no needle
  std::array<PunctureMaterial, kPunctureMaterials> material{};
  bool by_energy = false;       ///< the first rupture asks the energy, not the force
  Real shaft_n_per_m = 0.0;     ///< [N/m] k_b > 0 before the shaft slips
  Real lateral_n_per_m2 = 0.0;  ///< [N/m^2] k' >= 0 across, per inserted length
  Real mouth_m = 0.0;  ///< [m] > 0 from the axis: there a tip finds the channel again
};

[[nodiscard]] inline bool is_needle(const PunctureRules& rules) noexcept {
  return rules.materials > 0;
}

/// Null if the rules are valid, else what is wrong with them, one line.
[[nodiscard]] const char* check(const PunctureRules& rules) noexcept;

/// When a membrane broke; zero of one that broke in an earlier run.
struct Rupture {
  Real tip_m = 0.0;    ///< [m] z
  Real force_n = 0.0;  ///< [N] along the axis, on the tool, before it fell
};

struct Channel {
  Vector3 entry_m = Vector3::Zero();  ///< [m] x_0, of the tool's reference point
  Vector3 axis = Vector3::Zero();     ///< [-] a, outward unit
  NodePuncture layers;                ///< along the axis
  std::int32_t layer = 0;             ///< that the tip has broken into
  Real depth_m = 0.0;                 ///< [m] L >= 0, only grows
  std::array<Rupture, kPunctureLayers> broke{};  ///< of the layers [0, layer]
  // The needle in it.
  Real inserted_m = 0.0;                ///< [m] l
  Real shaft_m = 0.0;                   ///< [m] zeta, inward positive
  Vector3 lateral_m = Vector3::Zero();  ///< [m] y, across the axis
  bool slips = false;
  Real rested_s = 0.0;  ///< [s] since it slipped

  /// z of a tip at x.
  [[nodiscard]] Real tip_m(const Vector3& x_m) const noexcept {
    return axis.dot(entry_m - x_m);
  }
  /// Where the field is asked for a tip at x.
  [[nodiscard]] Vector3 image_m(const Vector3& x_m) const noexcept {
    return entry_m - (tip_m(x_m) - depth_m) * axis;
  }
};

/// [s] A shaft that has rested so long bears its static friction again.
constexpr Real kShaftRestS = 0.1;

/// F_c of the layer that the tip stands in [N].
[[nodiscard]] Real cutting_n(const PunctureRules& rules,
                             const Channel& channel) noexcept;

/// Depth of the next boundary [m]; infinite where there is none.
[[nodiscard]] Real boundary_m(const Channel& channel) noexcept;

/// Whether the membrane that the channel ends at breaks. @param channel at a boundary.
/// @param force_n [N] f. @param energy_j [J] E.
[[nodiscard]] bool breaks(const PunctureRules& rules, const Channel& channel,
                          Real force_n, Real energy_j) noexcept;

/// Friction of the inserted length [N], sum over layers.
struct ShaftFriction {
  Real kinetic_n = 0.0;
  Real static_n = 0.0;
};
[[nodiscard]] ShaftFriction friction_of(const PunctureRules& rules,
                                        const Channel& channel) noexcept;

/// Energy of shaft and lateral spring [J].
[[nodiscard]] Real held_j(const PunctureRules& rules, const Channel& channel) noexcept;

/// Their force on the tool [N].
[[nodiscard]] Vector3 held_n(const PunctureRules& rules,
                             const Channel& channel) noexcept;

/// The tip has moved, at frozen inserted length and limits.
void move(Channel& channel, const Vector3& moved_m) noexcept;

/// The inserted length follows the tip, the shaft slips. The energy never rises.
/// @param tip_m [m] z. @param dt_s [s] >= 0 of the tick.
void settle(const PunctureRules& rules, Channel& channel, Real tip_m,
            Real dt_s) noexcept;

/// The needle has left: nothing holds it.
void let_go(Channel& channel) noexcept;

}  // namespace palpate
