// A lateral fit as reports for programs name it.
#pragma once

#include <nlohmann/json.hpp>

#include "fitting/lateral/lateral_fit.h"

namespace palpate {

/// The better law at the top: law, friction, presliding_m, runs; `laws` compares both.
[[nodiscard]] nlohmann::ordered_json to_json(const LateralFit& fit);

}  // namespace palpate
