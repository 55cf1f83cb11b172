// How far off a linear press is between the depths at which the nonlinear body's
// response corrects it.
#pragma once

#include <span>

#include "precompute/contact/linear_indentation.h"
#include "precompute/press/relative_correction.h"

namespace palpate {

/// Estimate of the error of force between knots, over the force, or over a tenth of the
/// largest where that is more [-]. Each knot but the last is left out and interpolated
/// between the others. The knot's deviation grows with the product of its distances to
/// the knots beside it. The deviation is scaled to the middle of the longer of the two
/// intervals between these knots. The largest scaled deviation of all is taken. Between
/// two samples in a row nothing is interpolated. The estimate is no bound: for powers
/// of 1.5 to 4 of the depth the estimate is 0.2 to 5 times the error
/// (tests/precompute/press/interpolation_error_test.cc).
/// @param path linear, from the first touch to the last knot.
/// @param knots (k >= 1) at samples of the path: nonlinear minus linear force, over the
/// linear one [-].
[[nodiscard]] double interpolation_error(
    std::span<const IndentationSample> path,
    std::span<const RelativeCorrection::Knot> knots);

}  // namespace palpate
