// Fitted parameters as reports for programs name them.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "fitting/curve/curve_feature.h"
#include "fitting/curve/power_law_fit.h"
#include "fitting/numerics/interval_estimate.h"

namespace palpate {

/// Objects of name, value, unit, standard_deviation, held.
[[nodiscard]] nlohmann::ordered_json to_json(
    const std::vector<FitParameter>& parameters);

/// kind, depth_m, depth_end_m, change, text.
[[nodiscard]] nlohmann::ordered_json to_json(const CurveFeature& feature);

/// value, standard_deviation, interval_95 [low, high]. Where there is none: null, the
/// reason "refused", and "above", the lower bound where one is known.
[[nodiscard]] nlohmann::ordered_json to_json(const IntervalEstimate& estimate);

/// Names of flags.
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<FitFlag>& flags);

}  // namespace palpate
