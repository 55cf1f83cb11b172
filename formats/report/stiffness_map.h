// How stiff a body is at each node, at one depth for all.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/response/response_table.h"

namespace palpate {

struct StiffnessMap {
  double depth_m = 0.0;                     ///< [m] common depth, along each direction
  std::vector<double> stiffness_n_per_m;    ///< (n) [N/m] f/d there; NaN: no response
  std::vector<std::int64_t> softest_first;  ///< nodes with a response, by stiffness
  double low_n_per_m = 0.0;                 ///< [N/m] colour range: 2nd percentile ...
  double high_n_per_m = 1.0;  ///< [N/m] ... to 98th, widened if they nearly agree
  bool clipped_low = false;   ///< some nodes lie below the range
  bool clipped_high = false;  ///< some nodes lie above it

  /// Place of a stiffness in the colour range, 0 to 1 inside it.
  [[nodiscard]] double place(double n_per_m) const {
    return (n_per_m - low_n_per_m) / (high_n_per_m - low_n_per_m);
  }
};

/// The common depth is half the table's largest, rounded down to 1, 2 or 5 times a
/// power of ten; a curve that ends before it goes on with its end slope. The secant
/// f/d, not the slope f': jumps of a coarse contact show in the slope, hardly in the
/// force.
[[nodiscard]] StiffnessMap stiffness_map(const ResponseTable& table);

}  // namespace palpate
