// Databases rounded to what a file can keep, and what that costs.
#pragma once

#include <span>

#include "formats/response_database.h"

namespace palpate {

/// The largest step of a scaled 16-bit number: values are k scale, k in [0,
/// kInt16Steps].
constexpr double kInt16Steps = 32767.0;

/// Scale of a node's values: their largest over kInt16Steps, rounded up to a float; 0
/// where all are 0. A float, because then k scale is exact in double precision and
/// rounding twice is rounding once.
[[nodiscard]] double int16_scale(std::span<const double> values);

/// The database as a reader finds it in a file of its own storage.precision: depths and
/// forces rounded, slopes, energies, largest slopes and the falling flag made anew.
/// @throws InputError naming the node whose depths the precision cannot tell apart.
[[nodiscard]] ResponseDatabase rounded(const ResponseDatabase& database);

}  // namespace palpate
