// Samples of a press during which the tool touches nothing.
#pragma once

#include <cstddef>
#include <vector>

#include "fitting/curve/measured_approach.h"
#include "fitting/curve/power_law_fit.h"

namespace palpate {

/// Indices of a measurement's samples, in order.
struct FreeSamples {
  std::vector<std::size_t> before;  ///< of the approach, before contact
  std::vector<std::size_t> after;   ///< of the retract, the later half of those beyond
};

/// Fewer say nothing of what is there without contact.
inline constexpr std::size_t kFreeMin = 10;

/// Those shallower than the contact point by 3 of its standard deviations and 2 % of
/// the largest depth. Of the retract the earlier half is left out: the tool may still
/// stick. Both empty without a contact point.
/// @param turned samples with the approach's signs, turned().
[[nodiscard]] FreeSamples free_samples(const Measurement& turned,
                                       const Approach& approach, const ContactFit& fit);

}  // namespace palpate
