// Who pressed, and on what.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "formats/response/tool_shape.h"

namespace palpate {

inline constexpr std::array<std::string_view, 5> kIndenterShapes{
    "sphere", "flat-punch", "cone", "plate", "unknown"};

/// The moduli follow from it.
struct Indenter {
  std::string shape = "unknown";  ///< one of kIndenterShapes
  double radius_m = 0.0;  ///< [m] > 0 of a sphere or a punch; of a plate's cylinder
  double half_angle_rad = 0.0;  ///< [rad] (0, pi/2) of a cone, from its axis
  double height_m = 0.0;        ///< [m] > 0 of the cylinder under a plate
  double thickness_m = 0.0;     ///< [m] of the layer on a rigid base; 0: very thick
  double poissons_ratio = 0.5;  ///< [-] (-1, 0.5] of the sample
  // Standard deviations of the above, as far as they are known.
  double radius_sd_m = 0.0, half_angle_sd_rad = 0.0, height_sd_m = 0.0;
  double thickness_sd_m = 0.0, poissons_ratio_sd = 0.0;
};

/// The indenter as the database holds it, named "probe", without friction; none of a
/// plate and of the unknown, which the runtime does not render.
[[nodiscard]] std::optional<ToolShape> rendered_tool(const Indenter& indenter);

}  // namespace palpate
