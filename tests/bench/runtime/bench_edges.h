// `runtime_bench edges`: by how much the force of a stored body steps where the tool
// crosses from one surface element to the next.
//
// The tool is at the middle of every edge whose elements have responses at all nodes,
// over the edge by the normals there. The tool moves by 1 um across the edge. The step
// is the change of the force's part along the surface, over the force.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "runtime/account/local_model.h"

namespace palpate {

struct EdgesBenchRow {
  LocalModel model = LocalModel::kPotential;
  double depth_m = 0.0;  ///< [m] normal penetration by the nodes' lines
  int edges = 0;         ///< of so many; those where the tool is beside them are not
  double median = 0.0;   ///< [-] step over force
  double p95 = 0.0;
  double largest = 0.0;
  double turn_p95_rad = 0.0;  ///< [rad] that the force turns by
  double turn_largest_rad = 0.0;
};

/// Of both fields, at a fifth, three fifths and all of the depth that was pressed.
/// Without friction and memory.
[[nodiscard]] std::vector<EdgesBenchRow> run_edges_bench(
    const ResponseDatabase& database, const ResponseTable& table);

[[nodiscard]] std::string table_text(const std::vector<EdgesBenchRow>& rows);
[[nodiscard]] std::string to_json(const std::vector<EdgesBenchRow>& rows);

}  // namespace palpate
