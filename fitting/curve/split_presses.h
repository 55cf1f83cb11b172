// The presses of a measurement that holds several.
#pragma once

#include <vector>

#include "formats/database/response_database.h"

namespace palpate {

constexpr double kPressShareMin = 0.2;  ///< [-] of the travel: less is backlash

/// Pieces of the measurement in turn, each with one press, what is free before it and
/// what follows it: hold and release. A press begins at the lowest displacement between
/// going back and rising, each by more than kPressShareMin of the whole travel.
/// Compression is the direction of the larger excursion from the first sample. Together
/// the pieces are the measurement, which is one piece without a second press. Runs and
/// relaxation are not carried over.
/// @param measurement times as many as displacements, or none.
[[nodiscard]] std::vector<Measurement> split_presses(const Measurement& measurement);

}  // namespace palpate
