// How far off a linear press is between the depths at which the nonlinear body's
// response corrects it.
#pragma once

#include <span>

#include "precompute/contact/linear_indentation.h"
#include "precompute/press/relative_correction.h"

namespace palpate {

/// Error of force between knots, over the force, or over a tenth of the largest where
/// that is more [-]: the largest of what each knot but the last would be off by if it
/// had been interpolated between the others, times what errors in the middle of the
/// longer interval beside it are of that: they grow with the product of the distances
/// to the knots on both sides. Between two samples in a row nothing is interpolated.
/// @param path linear, from the first touch to the last knot.
/// @param knots (k >= 1) at samples of the path: nonlinear minus linear force, over the
///   linear one [-].
[[nodiscard]] double interpolation_error(
    std::span<const IndentationSample> path,
    std::span<const RelativeCorrection::Knot> knots);

}  // namespace palpate
