// The runs of a session as responses of its body: `palpate-fit surface`.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "fitting/session/session.h"
#include "fitting/surface/field_fit.h"

namespace palpate {

/// @param notes what was taken off the runs, a line each.
/// @throws InputError for an indenter that the runtime does not render, and fewer runs
/// than kProbesMin that can be read and placed. InputError too as session_probes(),
/// session_body() and fit_surface().
[[nodiscard]] SurfaceFit fit_session_surface(const Session& session,
                                             std::vector<std::string>& notes);

/// For programs: numbers that are not known as null.
[[nodiscard]] nlohmann::ordered_json to_json(const SurfaceFitReport& report,
                                             const std::vector<std::string>& notes);

}  // namespace palpate
