// Databases rounded to what a file can keep, and what that costs.
#pragma once

#include "formats/database/response_database.h"

namespace palpate {

/// The database as a reader finds it in a file of its own storage.precision. Depths and
/// forces are rounded; slopes, energies, largest slopes and the falling flag are made
/// anew.
/// @throws InputError naming the node whose depths the precision cannot tell apart.
[[nodiscard]] ResponseDatabase rounded(const ResponseDatabase& database);

}  // namespace palpate
