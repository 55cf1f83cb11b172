// Toughness of a layer from its cutting force.
//
//   J = F_c / w
//
// Symbols: J toughness [J/m^2], F_c cutting force [N], w width of the crack [m], for
// which the width of the needle's cutting edge is taken. Source: Gokgol, Basdogan,
// Canadinc 2012 (bovine liver: 164 J/m^2).
#pragma once

#include <string>

#include "fitting/numerics/interval_estimate.h"

namespace palpate {

/// Refused as the cutting force is. @param edge_width_m > 0. @throws InputError else.
[[nodiscard]] IntervalEstimate toughness_of(const IntervalEstimate& cutting_n,
                                            double edge_width_m);

/// One sentence where the toughness is above kToughestPuncture (puncture.h); empty
/// otherwise.
[[nodiscard]] std::string toughness_warning(const IntervalEstimate& toughness);

}  // namespace palpate
