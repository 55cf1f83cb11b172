// How the surface deforms under a host's tool, for drawing.
#pragma once

#include <span>

#include "runtime/c_api/host_body.h"

namespace palpate {

struct DisplacedSurface {
  Points moved_m;  ///< (n x 3) [m] in the world, of each vertex
  int known = 0;   ///< touching contacts with fields at all their corners
};

/// Stored displacement fields of the corners of the contacts' triangles, in proportion
/// to what each contact's own force sinks, added up (displaced_surface.h).
/// @param contacts as the tool gives them, now or before. @throws InputError for a body
/// that is not in memory, or a contact that is none of the tool's.
[[nodiscard]] DisplacedSurface displaced_surface(const HostBody& body,
                                                 const HostTool& tool,
                                                 std::span<const BodyContact> contacts);

}  // namespace palpate
