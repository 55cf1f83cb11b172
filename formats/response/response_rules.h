// What must hold of a node's response wherever one is handed on: between the stages of
// a computation, into a checkpoint, into a database.
#pragma once

#include <string>

#include "formats/response/response_table.h"

namespace palpate {

/// The first rule that a response breaks, with the value that breaks it, as the end of
/// a sentence; empty where it keeps all of them.
///
/// With a curve: at least two samples, as many forces as depths, both from 0; depths
/// [m] finite and strictly increasing, forces [N] finite and not negative; `direction`
/// and every `sample_direction` of length 1 to 1e-6, none of the latter or one for each
/// sample; tilt finite; spread [rad] in [0, pi]; touch offset [m] and error [-] finite,
/// the error not negative. Without a curve (kNone): no samples and no tilt.
[[nodiscard]] std::string broken_rule(const NodeResponse& response);

}  // namespace palpate
