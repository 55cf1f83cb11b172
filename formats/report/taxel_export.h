// Taxels under a pressed tool in formats that other programs read.
#pragma once

#include <string>

#include "formats/response/taxels.h"

namespace palpate {

/// A line per row of taxels, the first with the largest y, pressures [Pa] by commas:
/// as one looks at the surface from outside. Numbers read back as they were.
[[nodiscard]] std::string taxel_csv(const Taxels& taxels, const TaxelGrid& grid);

/// One object. Of the grid: pitch_m, pressure_pa (rows from the smallest y on),
/// force_n, beside_n. Of the contact: radius_m, middle_pa, centre_m, exponent,
/// error_relative. In the world: middle_m, outward, x, y.
[[nodiscard]] std::string taxel_json(const Taxels& taxels, const TaxelGrid& grid);

}  // namespace palpate
