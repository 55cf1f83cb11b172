// Fitted parameters as reports for programs name them.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "fitting/curve/power_law_fit.h"

namespace palpate {

/// Objects of name, value, unit, standard_deviation, held.
[[nodiscard]] nlohmann::ordered_json to_json(
    const std::vector<FitParameter>& parameters);

/// Names of flags.
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<FitFlag>& flags);

}  // namespace palpate
