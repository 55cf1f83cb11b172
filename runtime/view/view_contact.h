// Where the tool is over the body, and how it stands, for drawing.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "formats/database/response_database.h"
#include "formats/mesh/surface_search.h"
#include "formats/recording/tick_record.h"

namespace palpate {

struct ViewContact {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< [m] on the body at rest
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();   ///< [-] outward, unit
  std::int32_t triangle = -1;
  std::array<std::int32_t, 3> node{-1, -1, -1};  ///< its corners ...
  Eigen::Vector3d share =
      Eigen::Vector3d::Zero();  ///< [-] ... and the point's area coordinates
  double penetration_m = 0.0;  ///< [m] of the tool's lowest point along -normal, signed
  /// [m] the tool's height here over its nominal height, which ticks count depths from
  double over_nominal_m = 0.0;
  Eigen::Quaterniond turn =
      Eigen::Quaterniond::Identity();  ///< [-] from the tool's frame to the world
};

/// The point of the surface nearest to x_m, with the nodes' normals between them, and
/// the tool with its reference point there. A sphere and a tool without an axis of its
/// own stand along that normal, as they do when responses are computed.
/// @param from triangle to walk from; -1: the whole body is searched.
[[nodiscard]] ViewContact view_contact(const ResponseDatabase& database,
                                       const ToolShape& tool,
                                       const SurfaceSearch& search,
                                       const Eigen::Vector3d& x_m, std::int32_t from);

/// [m] at which the tool's reference point stands over a surface that it touches. For
/// an endless flank below its own tip it is the height of a tool along the normal.
[[nodiscard]] double drawn_height_m(const ToolShape& tool,
                                    const Eigen::Vector3d& outward);

}  // namespace palpate
