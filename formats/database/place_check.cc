#include "formats/database/place_check.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

#include "formats/response/response_curve.h"
#include "formats/response/tool_support.h"

namespace palpate {
namespace {

// A response with its curve, which must have samples.
struct PlacedResponse {
  PlacedResponse(const NodeResponse& node, const Eigen::Vector3d& outward)
      : curve(node.depth_m, node.force_n),
        placed{curve.view(),
               node.touch_offset_m,
               std::abs(outward.dot(node.direction)),
               node.direction,
               outward,
               node.tilt,
               node.sample_direction.empty()
                   ? std::span<const double>{}
                   : std::span(node.sample_direction.front().data(),
                               3 * node.sample_direction.size())} {}

  ResponseCurve curve;
  PlacedCurve placed;
};

bool has_samples(const NodeResponse& response) {
  return response.depth_m.size() > 1;
}

// The field of the answers, where the element responds at all of its vertices.
void compare_between(const ResponseDatabase& database,
                     const std::vector<NodeResponse>& response,
                     const StoredForces& stored, PlaceCheck& check) {
  const std::size_t tool = database.tools.size() - 1;
  const CheckCorners corners(database.body, check);
  double end_m = std::numeric_limits<double>::infinity();
  for (const std::size_t v : corners.vertex) {
    if (!has_samples(response[v])) {
      return;
    }
    const Eigen::Vector3d n =
        database.normal.row(static_cast<Eigen::Index>(v)).transpose();
    // As far as all three corners reach.
    end_m = std::min(end_m, PlacedResponse(response[v], n).placed.end_m());
  }
  // The tool's reference point at penetration delta: x = at + (S(n) - delta) n.
  const Eigen::Vector3d outward = corners.blended(database.normal).normalized();
  const Eigen::Vector3d at_m = corners.blended(database.body.position_m);
  const double height_m = height_at_touch_m(database.tools[tool].tool, outward);
  const PlacedResponse better(check.response, outward);
  const std::vector<double> depth_m = compared_depths_m(end_m, better.placed);
  Points x_m(std::ssize(depth_m), 3);
  for (std::size_t k = 0; k < depth_m.size(); ++k) {
    x_m.row(static_cast<Eigen::Index>(k)) =
        (at_m + (height_m - depth_m[k]) * outward).transpose();
  }
  const Points force_n = stored(database, tool, x_m);
  for (std::size_t i = 0; i < kErrorsFrom.size(); ++i) {
    // Errors from a share of the better curve's depth on; 1e-12 keeps the depth that is
    // meant.
    const double from_m = kErrorsFrom[i] * better.placed.end_m();
    const auto first =
        std::lower_bound(depth_m.begin(), depth_m.end(), from_m * (1.0 - 1e-12)) -
        depth_m.begin();
    check.found_from[i] =
        force_difference(std::span(depth_m).subspan(static_cast<std::size_t>(first)),
                         force_n.bottomRows(force_n.rows() - first), better.placed);
  }
  check.found = check.found_from.front();
}

}  // namespace

double PlaceCheck::error(double found_here) const {
  return place.triangle < 0 ? kErrorPerCheck * found_here
                            : std::hypot(found_here, response.error_relative);
}

CheckCorners::CheckCorners(const SurfaceMesh& body, const PlaceCheck& check) {
  vertex.fill(static_cast<std::size_t>(check.vertex));
  if (check.place.triangle >= 0) {
    for (std::size_t j = 0; j < 3; ++j) {
      vertex[j] = static_cast<std::size_t>(
          body.triangle(check.place.triangle, static_cast<Eigen::Index>(j)));
    }
    share = check.place.area_coordinate;
  }
}

Eigen::Vector3d CheckCorners::blended(const Points& of) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < 3; ++j) {
    sum += share(static_cast<Eigen::Index>(j)) *
           of.row(static_cast<Eigen::Index>(vertex[j])).transpose();
  }
  return sum;
}

void compare(const ResponseDatabase& database,
             const std::vector<NodeResponse>& response, const StoredForces& stored,
             std::vector<PlaceCheck>& checks) {
  for (PlaceCheck& check : checks) {
    if (std::isinf(check.found) || !has_samples(check.response)) {
      continue;
    }
    if (check.place.triangle >= 0) {
      compare_between(database, response, stored, check);
    } else {
      check.found = response_difference(
          response[static_cast<std::size_t>(check.vertex)], check.response,
          database.normal.row(check.vertex).transpose());
    }
  }
}

double response_difference(const NodeResponse& response, const NodeResponse& reference,
                           const Eigen::Vector3d& outward) {
  if (!has_samples(response) || !has_samples(reference)) {
    return response.depth_m.size() == reference.depth_m.size() ? 0.0 : 1.0;
  }
  return force_difference(PlacedResponse(response, outward).placed,
                          PlacedResponse(reference, outward).placed);
}

}  // namespace palpate
