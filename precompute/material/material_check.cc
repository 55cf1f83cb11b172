#include "precompute/material/material_check.h"

#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

void check_positive_pa(std::string_view name, double value_pa) {
  if (!(value_pa > 0.0) || !std::isfinite(value_pa)) {
    throw InputError(fmt::format("{} is {} Pa; must be positive", name, value_pa));
  }
}

void check_poissons_ratio(double poissons_ratio) {
  if (!(poissons_ratio > -1.0 && poissons_ratio < 0.5)) {
    throw InputError(
        fmt::format("Poisson's ratio is {}; must lie between -1 and 0.5, both excluded",
                    poissons_ratio));
  }
}

double shear_modulus_from(double youngs_modulus_pa, double poissons_ratio) {
  check_positive_pa("Young's modulus", youngs_modulus_pa);
  check_poissons_ratio(poissons_ratio);
  return youngs_modulus_pa / (2.0 * (1.0 + poissons_ratio));
}

double lame_lambda_from(double shear_modulus_pa, double poissons_ratio) {
  return 2.0 * shear_modulus_pa * poissons_ratio / (1.0 - 2.0 * poissons_ratio);
}

double bulk_modulus_from(double shear_modulus_pa, double poissons_ratio) {
  return 2.0 * shear_modulus_pa * (1.0 + poissons_ratio) /
         (3.0 * (1.0 - 2.0 * poissons_ratio));
}

}  // namespace palpate
