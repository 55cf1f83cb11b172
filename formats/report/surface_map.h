// A number at each node of a body that a picture shows in colours.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/response/response_table.h"

namespace palpate {

struct SurfaceMap {
  std::string name;                        ///< with unit: "stiffness [N/m]"
  std::string note;                        ///< what it is, in a few words
  std::string unit;                        ///< "N/m"
  double depth_m = 0.0;                    ///< [m] that it is of; 0: of none
  std::vector<double> value;               ///< (n) [unit]; NaN: no response
  std::vector<std::int64_t> lowest_first;  ///< nodes with a value, by it
  double low = 0.0;                        ///< [unit] colour range: 2nd percentile ...
  double high = 1.0;          ///< [unit] ... to 98th, widened if they nearly agree
  bool clipped_low = false;   ///< some nodes lie below the range
  bool clipped_high = false;  ///< some nodes lie above it

  /// Place of a value in the colour range, 0 to 1 inside it.
  [[nodiscard]] double place(double at) const { return (at - low) / (high - low); }
};

/// The depth [m] that stiffness is shown of. It is half the largest, rounded down to 1,
/// 2 or 5 times a power of ten. Where that is 0 it is 1 mm.
[[nodiscard]] double map_depth_m(double depth_max_m);

/// f/d at map_depth_m() of the table's largest depth, common to all nodes. A curve that
/// ends before that depth goes on with its end slope. The secant f/d, not the slope f':
/// jumps of a coarse contact show in the slope, hardly in the force.
[[nodiscard]] SurfaceMap stiffness_map(const ResponseTable& table);

/// The share of a held force that relaxes, sum of g_k [%].
/// @param table whose responses relax.
[[nodiscard]] SurfaceMap relaxation_map(const ResponseTable& table);

/// The share of a deep press that stays as a dent [%].
/// @param table whose responses leave dents.
[[nodiscard]] SurfaceMap dent_map(const ResponseTable& table);

/// By how much responses soften at most [%]. @param table whose responses soften.
[[nodiscard]] SurfaceMap softening_map(const ResponseTable& table);

/// Mean time in which it does, by share [s]. @param table whose responses relax.
[[nodiscard]] SurfaceMap relaxation_time_map(const ResponseTable& table);

}  // namespace palpate
