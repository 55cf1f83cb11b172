// Range checks that the factories of constitutive laws share.
#pragma once

#include <string_view>

namespace palpate {

/// @throws InputError naming the quantity and its value unless 0 < value < inf.
void check_positive_pa(std::string_view name, double value_pa);

/// @throws InputError unless -1 < poissons_ratio < 0.5.
void check_poissons_ratio(double poissons_ratio);

/// mu = E / (2 (1 + nu)) [Pa], both arguments checked.
[[nodiscard]] double shear_modulus_from(double youngs_modulus_pa,
                                        double poissons_ratio);

/// lambda = 2 mu nu / (1 - 2 nu) [Pa].
[[nodiscard]] double lame_lambda_from(double shear_modulus_pa, double poissons_ratio);

/// K = 2 mu (1 + nu) / (3 (1 - 2 nu)) = E / (3 (1 - 2 nu)) [Pa].
[[nodiscard]] double bulk_modulus_from(double shear_modulus_pa, double poissons_ratio);

}  // namespace palpate
