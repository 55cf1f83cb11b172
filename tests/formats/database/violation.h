// Rules of a database, broken one at a time.
#pragma once

#include <functional>
#include <limits>
#include <ostream>

#include "formats/database/response_database.h"

namespace palpate {

/// What breaks nearly every rule.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// One rule, broken in what a test gives.
template <typename What>
struct Violation {
  const char* name;
  std::function<void(What&)> make;
  const char* message;  ///< of the error, or a part of it
};

template <typename What>
void PrintTo(const Violation<What>& violation, std::ostream* out) {
  *out << violation.name;
}

/// Of the small database: small_database().
inline ResponseTable& tip(ResponseDatabase& database) {
  return database.tools[0];
}

}  // namespace palpate
