// A picture of what a body feels like: a map of it beside a few curves.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "formats/database/response_database.h"

namespace palpate {

/// What the body is coloured by (surface_map.h).
enum class Shown { kStiffness, kRelaxation, kTime, kDents, kSoftening };

/// Their names for users, in the enumeration's order.
constexpr std::array<std::string_view, 5> kShownNames{"stiffness", "relaxation", "time",
                                                      "dents", "softening"};

/// A self-contained SVG, 1200 x 600 px: the body coloured, with colour bar and scale
/// bar, and a plot of some nodes. The nodes are from the lowest to the highest value.
/// The plot shows the nodes' responses for stiffness and for yielding, else what stays
/// of a force that is held. Equal input gives equal text.
/// @param table one of the database's tools.
/// @throws InputError for maps of relaxation or yielding of a tool without.
[[nodiscard]] std::string surface_picture(const ResponseDatabase& database,
                                          const ResponseTable& table,
                                          Shown shown = Shown::kStiffness);

}  // namespace palpate
