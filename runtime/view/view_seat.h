// Where over a body the tools of a view begin, and where they are lifted to.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "formats/database/response_database.h"

namespace palpate {

/// [m] above touch: the depth of the deepest curve, 5 mm at least.
[[nodiscard]] double clearance_m(const ResponseTable& table);

/// [m] Reference point of a tool that is clear of the body over a point of it.
[[nodiscard]] Eigen::Vector3d lifted_m(const ResponseTable& table,
                                       const Eigen::Quaterniond& turn,
                                       const Eigen::Vector3d& point_m,
                                       const Eigen::Vector3d& normal);

/// The node that each hand begins over. The first is one to press, without responses
/// yet the highest one. A second hand begins beside it.
[[nodiscard]] std::vector<std::int32_t> nodes_to_begin_over(
    const ResponseDatabase& database, const std::vector<const ResponseTable*>& tables);

}  // namespace palpate
