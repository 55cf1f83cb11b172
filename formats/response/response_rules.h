// What must hold of a node's response wherever one is handed on: between the stages of
// a computation, into a checkpoint, into a database.
#pragma once

#include <string>

#include "formats/response/response_table.h"

namespace palpate {

/// The first rule that a response breaks, with the value that breaks the rule, as the
/// end of a sentence. Empty where the response keeps all rules.
///
/// With a curve: at least two samples, as many forces as depths, both from 0. Depths
/// [m] are finite and strictly increasing, forces [N] finite and not negative.
/// `direction` and every `sample_direction` have length 1 to 1e-6; there is none of the
/// latter or one for each sample. The tilt is finite; the spread [rad] is in [0, pi].
/// Touch offset [m] and error [-] are finite, the error not negative. Without a curve
/// (kNone): no samples and no tilt.
[[nodiscard]] std::string broken_rule(const NodeResponse& response);

}  // namespace palpate
