// Where a session was measured, on the body: a part of its page.
#pragma once

#include <string>

#include "fitting/session/batch.h"

namespace palpate {

/// HTML of a body that the user can turn, with a mark at each place that was measured.
/// A mark's colour is the median stiffness of the place's runs that are not skipped,
/// its edge their best verdict. A click names the runs. Marks lie on the surface point
/// nearest to the place. Empty without a mesh or without positions; one line with the
/// reason where the mesh cannot be read. Links lead to the elements "run0", "run1", ...
/// of the page.
[[nodiscard]] std::string batch_map(const Session& session, const BatchReport& report);

}  // namespace palpate
