// Relaxation of a press for programs.
#pragma once

#include <nlohmann/json.hpp>

#include "fitting/curve/time_effects.h"

namespace palpate {

/// `refused` alone where there is none.
[[nodiscard]] nlohmann::ordered_json relaxation_json(const Relaxation& relaxation);

}  // namespace palpate
