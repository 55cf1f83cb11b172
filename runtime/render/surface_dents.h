// What of a surface's memory is not gone: for drawing and for summaries, not for the
// fast step.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/fast/fast_step.h"

namespace palpate {

/// A memory site that carries force.
struct SurfaceDent {
  std::int32_t site = -1;  ///< as the database counts
  double carried_n = 0.0;  ///< [N] s > 0: the force of its dent's depth
};

/// Of a state between two steps: sites at hand and in the table, as they are now.
[[nodiscard]] std::vector<SurfaceDent> surface_dents(const FastState& state);

}  // namespace palpate
