// Where the tool is over the body, for drawing.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "formats/recording.h"
#include "formats/response_database.h"
#include "runtime/surface_search.h"

namespace palpate {

struct ViewContact {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< [m] on the body at rest
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();   ///< [-] outward, unit
  std::int32_t triangle = -1;
};

/// The point of the surface nearest to x_m, with the nodes' normals between them.
/// @param from triangle to walk from; -1: the whole body is searched.
[[nodiscard]] ViewContact view_contact(const ResponseDatabase& database,
                                       const SurfaceSearch& search,
                                       const Eigen::Vector3d& x_m, std::int32_t from);

}  // namespace palpate
