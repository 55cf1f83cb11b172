// The friction of a contact as the latest step left it: what hosts and pages are shown.
#pragma once

#include <array>

#include "runtime/fast/fast_step.h"
#include "runtime/realtime/spsc_ring.h"

namespace palpate {

/// All are zero where nothing rubs; vectors are of the world.
struct FrictionSeen {
  double n_per_m = 0.0;  ///< [N/m] of the friction spring, or the mean of K
  double limit_n = 0.0;  ///< [N] mu F_n
  std::array<double, 3> stretch_m{};  ///< [m] of the spring
  std::array<double, 3> force_n{};    ///< [N] of the spring on the tool
  std::array<double, 3> tool_m{};     ///< [m] whose movement stretches the spring ...
  std::array<double, 3> normal{};     ///< [-] ... across this, unit
};

/// Of a potential field; other models show none.
[[nodiscard]] FrictionSeen friction_seen(const FastState& state) noexcept;

/// Every tick, from the fast thread to one reader. 0.5 MB; 2 s at 2 kHz.
using FrictionWatch = SpscRing<FrictionSeen, 4096>;

}  // namespace palpate
