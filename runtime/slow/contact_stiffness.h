// How stiff the contacts of a tool are together, where its body is stiffest.
#pragma once

#include "formats/database/response_database.h"
#include "formats/response/response_table.h"
#include "runtime/device/stability_margin.h"
#include "runtime/device/wrench_margin.h"
#include "runtime/fast/coupled_set.h"

namespace palpate {

/// All contacts of port 0 on the node with the largest slope k, its row of compliance
/// between them: (diag(1/k) + C)^-1. Where that is not positive definite, diag(k). An
/// estimate: elsewhere contacts couple otherwise.
/// @param set of the table's tool. @param stiffest of the table.
[[nodiscard]] ContactStiffness contact_stiffness(const ResponseTable& table,
                                                 const CoupledSet& set,
                                                 const RenderedStiffness& stiffest);

/// Sums over all contacts of a tool, as if each pressed a body of its own: more than
/// they have together where they sink one another, as contacts on one side of a body
/// do; no bound where one lifts another. @param force_max_n [N] > 0 that they share.
[[nodiscard]] RenderedStiffness stiffness_of_contacts(const ResponseDatabase& database,
                                                      const ResponseTable& tool,
                                                      double force_max_n);

}  // namespace palpate
