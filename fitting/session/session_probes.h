// The runs of a session as probes of a body.
#pragma once

#include <string>
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

/// One press of a run: the first, unless the session's cycle chooses another.
/// @throws InputError for the cycle "all", and as read_run() and chosen_cycles().
[[nodiscard]] Measurement chosen_press(const Session& session,
                                       const Measurement& measurement);

/// Reads and fits every run that has a position: one press of each (split_presses), the
/// first unless the session's cycle chooses another. The fit is by the best of the
/// session's families, the frame's deflection and drifts with time taken off. A run
/// that cannot be read, has no position or has fewer presses than its cycle is listed
/// in `left_out` with its reason. Listed too is a run of a specimen that sticks by more
/// than kAdhesionShareMax of its largest force. No such run stops the others.
/// @param notes what was taken off, one line each.
/// @throws InputError as session_frame(), and for the cycle "all".
[[nodiscard]] std::vector<SurfaceProbe> session_probes(
    const Session& session, std::vector<LeftOutProbe>& left_out,
    std::vector<std::string>& notes);

constexpr double kAdhesionShareMax = 0.1;  ///< [-] of the largest force

/// The surface that the session names; turned if it is closed and inside out.
/// @param notes gains lines as read_surface() has them.
/// @throws InputError if it names none, and as read_surface() does.
[[nodiscard]] SurfaceMesh session_body(const Session& session,
                                       std::vector<std::string>* notes = nullptr);

}  // namespace palpate
