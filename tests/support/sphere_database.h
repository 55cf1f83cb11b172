// A generated body of any size with a plausible response at every node.
#pragma once

#include <cstdint>

#include "formats/database/response_database.h"

namespace palpate {

/// A sphere of radius 0.1 m with 2 + 2 rings^2 nodes on rings of latitude, and
/// responses k d^1.5 whose stiffness varies smoothly over it: two poles, `rings` rings
/// of 2 * rings nodes. @param samples per curve, to 5 mm.
[[nodiscard]] ResponseDatabase sphere_database(std::int32_t rings, int samples);

}  // namespace palpate
