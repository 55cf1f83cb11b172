// A picture of what a body feels like: its stiffness map beside a few curves.
#pragma once

#include <string>

#include "formats/database/response_database.h"

namespace palpate {

/// A self-contained SVG, 1200 x 600 px: the body coloured by the stiffness that the
/// table's tool feels at a common depth, with colour bar and scale bar, and a plot of
/// the softest to the stiffest response. Equal input gives equal text.
/// @param table  one of the database's tools.
[[nodiscard]] std::string stiffness_picture(const ResponseDatabase& database,
                                            const ResponseTable& table);

}  // namespace palpate
