// A lateral fit as reports for programs name it.
#pragma once

#include <nlohmann/json.hpp>

#include "fitting/lateral/lateral_fit.h"
#include "fitting/lateral/lateral_plane.h"

namespace palpate {

/// The better law at the top: law, friction, presliding_m, runs; `laws` compares both.
[[nodiscard]] nlohmann::ordered_json to_json(const LateralFit& fit);

/// stiffness_n_per_m has xx, xy and yy.
[[nodiscard]] nlohmann::ordered_json to_json(const PlaneFit& fit);

}  // namespace palpate
