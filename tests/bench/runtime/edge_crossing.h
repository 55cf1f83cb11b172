// Where a tool crosses the edges of a stored body.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "formats/database/response_database.h"

namespace palpate {

/// The middle of an edge between two elements that respond at all nodes.
struct EdgeCrossing {
  std::int32_t triangle = -1;
  std::int32_t neighbour = -1;
  Eigen::Vector3d middle_m;  ///< [m]
  Eigen::Vector3d normal;    ///< [-] unit, mean of the ends'
  Eigen::Vector3d across;    ///< [-] unit, from the neighbour to the triangle
};

/// Each edge once. @param table of the database.
[[nodiscard]] std::vector<EdgeCrossing> edge_crossings(const ResponseDatabase& database,
                                                       const ResponseTable& table);

}  // namespace palpate
