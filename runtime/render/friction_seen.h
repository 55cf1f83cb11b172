// The friction of a contact as the latest step left it: what hosts and pages are shown.
#pragma once

#include "runtime/fast/fast_step.h"
#include "runtime/realtime/spsc_ring.h"

namespace palpate {

struct FrictionSeen {
  FrictionSpring spring;             ///< its n_per_m is 0 where nothing rubs
  Vector3 tool_m = Vector3::Zero();  ///< [m] whose movement stretches the spring ...
  Vector3 normal = Vector3::Zero();  ///< [-] ... across this, unit
};

/// Of a potential field; other models show none.
[[nodiscard]] FrictionSeen friction_seen(const FastState& state) noexcept;

/// Every tick, from the fast thread to one reader. 0.7 MB; 2 s at 2 kHz.
using FrictionWatch = SpscRing<FrictionSeen, 4096>;

}  // namespace palpate
