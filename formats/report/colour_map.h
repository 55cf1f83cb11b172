// Colours that a reader can turn back into numbers.
#pragma once

#include <string>

#include <Eigen/Core>

namespace palpate {

/// Red, green, blue in [0, 1], sRGB.
using Colour = Eigen::Vector3d;

/// The viridis map (van der Walt and Smith 2015), t in [0, 1], clamped. The map's
/// lightness grows evenly with t, also in grey print and for colour-blind eyes. NaN
/// gives its dark end.
[[nodiscard]] Colour viridis(double t);

/// The colour under light of the given strength: 1 leaves it, less darkens, more
/// lightens towards white.
[[nodiscard]] Colour lit(const Colour& colour, double light);

/// "#rrggbb"
[[nodiscard]] std::string hex(const Colour& colour);

}  // namespace palpate
