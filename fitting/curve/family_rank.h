// Which family of curves describes an approach best.
#pragma once

#include "fitting/curve/family_fit.h"

namespace palpate {

/// States AICc and BIC of the fits, and sorts the fits, the best first. Fits that
/// converged come first, and of these the fits that do not miss. Within that the order
/// is by the choice's criterion. A family that may fall comes after those that may not,
/// unless it is decisively better than all of them.
/// @param choice its fits with `misses`, `deviance` and, for "cross-validation",
///   `cross_rms_n`.
void rank_fits(FamilyChoice& choice);

}  // namespace palpate
