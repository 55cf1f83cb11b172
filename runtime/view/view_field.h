// How the surface moves under a node that is pressed, for pages that draw it.
#pragma once

#include <cstdint>
#include <string>

#include "formats/response/response_table.h"

namespace palpate {

/// The stored displacements of the surface's vertices under a node, as JSON. "depth_m"
/// is the normal penetration at which they hold (they are in proportion to it).
/// "displacement" is x y z of every vertex in turn, little-endian int16 in base64.
/// Multiplied with "scale_m" each is off by at most half of "scale_m". "depth_m" is
/// null where the table holds no field of the node; of several the deepest is taken.
/// O(n m) in the vertices and modes. @throws InputError for a node that is not there.
[[nodiscard]] std::string field_text(const ResponseTable& table, std::int32_t node);

}  // namespace palpate
