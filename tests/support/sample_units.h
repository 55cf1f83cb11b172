// Units of a made-up computation, for tests of what keeps and merges them.
#pragma once

#include <vector>

#include "formats/database/work_unit.h"

namespace palpate {

/// An octahedron of 6 nodes, 5 of them reachable, one tool, 3 units. Every field has a
/// value of its own.
[[nodiscard]] JobDescription sample_plan();

/// Unit 0 solves vertices 0 and 1 and interpolates 2, over the budget. Unit 1 solves 3
/// in part and fails at 4. Unit 2 checks vertex 0: forces are 1.1 times unit 0's.
[[nodiscard]] std::vector<WorkUnitOutcome> sample_units();

}  // namespace palpate
