// The pressure laws of a tool's responses (pressure_law.h) in formats that other
// programs read.
#pragma once

#include <string>

#include "formats/database/response_database.h"

namespace palpate {

/// Depths of each node, even from 0 to the node's largest.
constexpr int kPressureDepths = 33;

/// A line per node and depth: node, x_m, y_m, z_m, radius_m, depth_m, pressure_pa,
/// after a line of these names. Numbers read back as they were. @throws InputError for
/// another tool than a sphere.
[[nodiscard]] std::string pressure_csv(const ResponseDatabase& database,
                                       const ResponseTable& table);

/// One object: the tool's name and radius, and per node null or depth_m, pressure_pa,
/// slope_pa_per_m, misfit_relative and force_error_relative. @throws as pressure_csv().
[[nodiscard]] std::string pressure_json(const ResponseDatabase& database,
                                        const ResponseTable& table);

}  // namespace palpate
