// What was taken off a press for the machine's sake, for people and for programs.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "fitting/curve/corrected_press.h"
#include "fitting/material/indenter.h"

namespace palpate {

/// Sentences on frame, drift with time and adhesion; empty where there is nothing to
/// tell. Works of adhesion where the indenter is a sphere.
[[nodiscard]] std::string corrections_text(const PressCorrections& corrections,
                                           const Indenter& indenter);

/// All of it, numbers that are not known as null.
[[nodiscard]] nlohmann::ordered_json corrections_json(
    const PressCorrections& corrections, const Indenter& indenter);

}  // namespace palpate
