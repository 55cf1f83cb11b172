// A database in formats that other programs read.
#pragma once

#include <string>

#include "formats/database/response_database.h"

namespace palpate {

/// VTK's XML format for unstructured grids, ASCII: the body, and per node stiffness,
/// depth_max, error, origin, flags and direction of a tool. Of contacts
/// (contact_table.h) also contact_radius_m and lateral_n_per_m (xx, xy, yy), both at
/// the largest depth.
[[nodiscard]] std::string to_vtu(const ResponseDatabase& database,
                                 const ResponseTable& table);

/// A line per sample: node, x_m, y_m, z_m, depth_m, force_n, stiffness_n_per_m,
/// energy_j; of contacts also contact_radius_m, and lateral_xx_n_per_m to
/// lateral_yy_n_per_m in the node's frame. After a line of these names. Numbers read
/// back as they were.
[[nodiscard]] std::string to_csv(const ResponseDatabase& database,
                                 const ResponseTable& table);

/// One object: the tool, positions, triangles, and per node its response or null.
[[nodiscard]] std::string to_json_text(const ResponseDatabase& database,
                                       const ResponseTable& table);

}  // namespace palpate
