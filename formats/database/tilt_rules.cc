#include "formats/database/tilt_rules.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "formats/database/format_error.h"
#include "formats/response/tilt_line.h"

namespace palpate {
namespace {

constexpr double kOffPlane = 1e-9;

// What is wrong with a node's line; empty where nothing is.
std::string why_wrong(const TiltLine& line, const Eigen::Vector3d& outward,
                      const ResponseTable& table, std::int64_t node,
                      double longest_edge_m) {
  if (table.curve(node).depth_m.empty()) {
    return line == TiltLine{} ? "" : "must be 0 without response";
  }
  const double end_m = tilt_range(table, node, outward).end_m;
  const double off = std::max(std::abs(line.tilt.dot(outward)),
                              std::abs(line.by_depth_per_m.dot(outward)) * end_m);
  if (!(off <= kOffPlane)) {
    return "must be tangent to the normal";
  }
  if (!is_within_limits(line, end_m, longest_edge_m)) {
    return fmt::format(
        "must be at most {} to {} m, and change by at most {} over an edge of {} m",
        kTiltMost, end_m, kTiltChangeMost, longest_edge_m);
  }
  return "";
}

}  // namespace

void check_tilts(const Points& normal, const ResponseTable& table, std::int64_t first,
                 std::span<const double> longest_edge_m) {
  const std::string& tool = table.tool.name;
  for (const Points* rows : {&table.tilt, &table.tilt_by_depth_per_m}) {
    if (rows->rows() != table.tilt.rows() ||
        (rows->rows() != 0 && rows->rows() != table.nodes())) {
      fail("/tools/{}: tilt has {} rows and tilt_by_depth_per_m {}, must have {}", tool,
           table.tilt.rows(), table.tilt_by_depth_per_m.rows(), table.nodes());
    }
  }
  for (Eigen::Index i = 0; i < table.tilt.rows(); ++i) {
    const TiltLine line{.tilt = table.tilt.row(i).transpose(),
                        .by_depth_per_m = table.tilt_by_depth_per_m.row(i).transpose()};
    const std::string wrong = why_wrong(
        line, normal.row(i).transpose(), table, i,
        longest_edge_m.empty() ? 0.0 : longest_edge_m[static_cast<std::size_t>(i)]);
    if (!wrong.empty()) {
      fail("/tools/{}/tilt: node {} has ({}, {}, {}) and ({}, {}, {}) 1/m by depth, {}",
           tool, first + i, line.tilt.x(), line.tilt.y(), line.tilt.z(),
           line.by_depth_per_m.x(), line.by_depth_per_m.y(), line.by_depth_per_m.z(),
           wrong);
    }
  }
}

}  // namespace palpate
