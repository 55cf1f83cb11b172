// What the rules of the database's format are written with.
#pragma once

#include <limits>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

/// What is finite is at most this.
inline constexpr double kLargest = std::numeric_limits<double>::max();
/// A unit vector to this accuracy, or a sum of shares: rounding of a normalisation,
/// with room for float32.
inline constexpr double kUnitTolerance = 1e-6;

/// @throws FormatError
template <typename... Values>
[[noreturn]] void fail(fmt::format_string<Values...> what, Values&&... values) {
  throw FormatError(fmt::format(what, std::forward<Values>(values)...));
}

}  // namespace palpate
