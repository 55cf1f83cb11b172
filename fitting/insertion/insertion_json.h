// A needle's fit as reports for programs name it.
#pragma once

#include <nlohmann/json.hpp>

#include "fitting/insertion/needle_fit.h"

namespace palpate {

/// value, standard_deviation, interval_95 [low, high]; null with the reason "refused"
/// where there is none.
[[nodiscard]] nlohmann::ordered_json to_json(const NeedleEstimate& estimate);

/// curve, ruptures, layers, friction, baselines, noise, notes.
[[nodiscard]] nlohmann::ordered_json to_json(const NeedleFit& fit);

}  // namespace palpate
