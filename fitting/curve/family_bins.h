// The two cubics that go through means of bins of the samples: monotone-cubic, whose
// forces rise, and interpolating, whose may fall.
#pragma once

#include <string_view>

#include "fitting/curve/family_solve.h"

namespace palpate {

/// Sixteen bins of even depth, halved where the curve is off by more than in most of
/// them. Baseline: the mean of the samples before contact, the power law's drift taken
/// off; of the first three where they are fewer. Its error is shared by all forces.
/// @param name "monotone-cubic" or "interpolating"
/// @param contact held there [-]
[[nodiscard]] FamilySolution solve_bins(const FamilyData& data, std::string_view name,
                                        double contact);

}  // namespace palpate
