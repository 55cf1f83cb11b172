// What fits print and write of their estimates.
#pragma once

#include <string>
#include <vector>

#include "fitting/numerics/interval_estimate.h"

namespace palpate {

/// One line on stdout: value, standard deviation, unit and 95 % interval; or why there
/// is none, with the lower bound where one is known.
void print_estimate(const std::string& name, const IntervalEstimate& estimate,
                    const std::string& unit);

/// "a.csv, b.csv"
[[nodiscard]] std::string joined_names(const std::vector<std::string>& files);

/// Atomically.
void write_scene_part(const std::string& text, const std::string& file);

}  // namespace palpate
