// An indenter as flags and arguments tell it: only what its shape has.
#pragma once

#include <optional>
#include <string>

#include "fitting/material/indenter.h"

namespace palpate {

struct IndenterOptions {
  std::string shape;  ///< of kIndenterShapes but "unknown"; empty: not given
  std::optional<double> radius_m, half_angle_deg, height_m, thickness_m;
  double poissons_ratio = 0.5;
  // Standard deviations, for the modulus' interval.
  std::optional<double> radius_sd_m, half_angle_sd_deg, height_sd_m, thickness_sd_m;
  std::optional<double> poissons_ratio_sd;
};

/// "unknown" where no shape is stated.
/// @throws InputError for a flag that the shape needs and misses, or does not have, and
/// for a value out of range. The error names flags, "--radius-m".
[[nodiscard]] Indenter indenter_of(const IndenterOptions& options);

}  // namespace palpate
