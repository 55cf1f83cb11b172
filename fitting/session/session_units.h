// Whether a session's positions and its body can be in the units that it states.
#pragma once

#include <string>
#include <vector>

#include "fitting/session/session.h"
#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// [-] of the body's diagonal: positions lie on a body within it.
inline constexpr double kOnBodyShare = 0.1;

/// Positions of a slip of the unit: more than half lie farther than kOnBodyShare from
/// the body. Or they fill less than a hundredth of its diagonal, where 10, 100 or 1000
/// times as large they would lie on the body, too.
/// @param body session_body(). @return a line each for what may be a slip.
/// @throws InputError for positions off the body. It names the keys that hold the
/// units, and the factor that brings the positions onto the body, if there is one.
[[nodiscard]] std::vector<std::string> unit_notes(const Session& session,
                                                  const SurfaceMesh& body);

/// A line if presses go deeper than half of the body's smallest side.
[[nodiscard]] std::vector<std::string> depth_notes(const Session& session,
                                                   const SurfaceMesh& body,
                                                   double depth_max_m);

}  // namespace palpate
