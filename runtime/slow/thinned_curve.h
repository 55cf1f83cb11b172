// A stored response curve in the fixed space of an element message.
#pragma once

#include "formats/response/curve_view.h"
#include "runtime/element/element.h"

namespace palpate {

/// Puts `curve` into the node's sample arrays. A curve of at most kElementSamples
/// samples is copied. Of a longer one, those samples are kept that describe it best
/// (each split at the largest remaining error). Slopes are the stored ones, limited to
/// the shape of what is kept (Fritsch & Carlson 1980). Energies are integrated anew, so
/// that E' = f still holds to rounding.
/// @returns largest difference of force [N] at the samples and halfway between them.
double set_curve(ElementNode& node, const CurveView& curve);

/// `slope` limited to [0, 3 secant]: a cubic with such slopes at both ends stays
/// between its ends (Fritsch & Carlson 1980).
[[nodiscard]] double monotone_slope(double slope, double secant) noexcept;

}  // namespace palpate
