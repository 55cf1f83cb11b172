// A generated body of any size with a plausible response at every node.
#pragma once

#include <cstdint>

#include "formats/database/response_database.h"

namespace palpate {

/// A sphere of radius 0.1 m with 2 + 2 rings^2 nodes: two poles, `rings` rings of
/// latitude of 2 * rings nodes. Responses are k d^1.5, with a stiffness that varies
/// smoothly over the sphere.
/// @param samples per curve, to 5 mm.
[[nodiscard]] ResponseDatabase sphere_database(std::int32_t rings, int samples);

}  // namespace palpate
