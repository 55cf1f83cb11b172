// Better solutions at places of the surface, and how far off they find what is stored.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "formats/database/response_database.h"
#include "formats/database/work_unit.h"
#include "formats/mesh/surface_search.h"
#include "formats/response/force_difference.h"

namespace palpate {

/// Shares of the largest depth from which on errors between vertices are stated. Errors
/// from the first share on are stated at the nodes, those from the others once for all
/// places.
inline constexpr std::array<double, 3> kErrorsFrom{kErrorCountsFrom, 0.25, 0.5};

/// A tool's better solution at one place.
struct PlaceCheck {
  std::int32_t vertex = -1;  ///< where the place is, or the nearest to it
  SurfacePoint place = {};   ///< triangle and area coordinates; -1: at the vertex
  NodeResponse response = {};
  /// [-] What compare() found, as force_difference() counts; NaN: nothing. Infinite
  /// before: the check failed, and nobody knows.
  double found = std::numeric_limits<double>::quiet_NaN();
  /// [-] The same from each of kErrorsFrom on; only between vertices.
  std::array<double, kErrorsFrom.size()> found_from{};

  /// [-] The error of what is stored, of which so much was found: at a vertex
  /// kErrorPerCheck of it. Between vertices the stored field and the check err
  /// independently, and the check's own error is what its press estimates.
  [[nodiscard]] double error(double found_here) const;
};

/// The corners of a check's place and their shares of it.
struct CheckCorners {
  std::array<std::size_t, 3> vertex{};
  Eigen::Vector3d share = Eigen::Vector3d::UnitX();  ///< [-] >= 0, sum 1

  CheckCorners(const SurfaceMesh& body, const PlaceCheck& check);

  /// Rows of the corners, weighted by their shares.
  [[nodiscard]] Eigen::Vector3d blended(const Points& of) const;
};

/// Compares what answers make of the checks' places: at a vertex its response, between
/// vertices the field, on places along the normal between theirs. A check without a
/// curve, and one in an element that does not respond at all of its vertices, finds
/// nothing. @param tool the last of the database. @param response of its vertices.
void compare(const ResponseDatabase& database,
             const std::vector<NodeResponse>& response, const StoredForces& stored,
             std::vector<PlaceCheck>& checks);

/// force_difference() of two responses of a node.
[[nodiscard]] double response_difference(const NodeResponse& response,
                                         const NodeResponse& reference,
                                         const Eigen::Vector3d& outward);

}  // namespace palpate
