// Fitted parameters as reports for programs name them.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "fitting/curve/curve_feature.h"
#include "fitting/curve/power_law_fit.h"

namespace palpate {

/// Objects of name, value, unit, standard_deviation, held.
[[nodiscard]] nlohmann::ordered_json to_json(
    const std::vector<FitParameter>& parameters);

/// kind, depth_m, depth_end_m, change, text.
[[nodiscard]] nlohmann::ordered_json to_json(const CurveFeature& feature);

/// Names of flags.
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<FitFlag>& flags);

}  // namespace palpate
