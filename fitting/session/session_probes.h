// The runs of a session as probes of a body.
#pragma once

#include <vector>

#include "fitting/session/session.h"
#include "fitting/surface/field_fit.h"
#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// The session's families fitted to an approach, best first by its criterion.
/// @param reference the power law's fit of it.
[[nodiscard]] FamilyChoice choose_family(const SessionFit& session,
                                         const Approach& approach,
                                         const ContactFit& reference);

/// Reads and fits every run that has a position: the first press of each
/// (split_presses), by the best of the session's families. A run that cannot be read,
/// or has no position, is listed in `left_out` with its reason; none stops the others.
[[nodiscard]] std::vector<SurfaceProbe> session_probes(
    const Session& session, std::vector<LeftOutProbe>& left_out);

/// The surface that the session names; turned if it is closed and inside out.
/// @throws InputError if it names none, and as read_surface() does.
[[nodiscard]] SurfaceMesh session_body(const Session& session);

}  // namespace palpate
