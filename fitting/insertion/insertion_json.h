// A needle's fit as reports for programs name it.
#pragma once

#include <nlohmann/json.hpp>

#include "fitting/insertion/needle_fit.h"

namespace palpate {

/// curve, ruptures, layers, friction, baselines, noise, notes.
[[nodiscard]] nlohmann::ordered_json to_json(const NeedleFit& fit);

}  // namespace palpate
