#include "runtime/slow/element_message.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"
#include "runtime/slow/thinned_curve.h"

namespace palpate {
namespace {

// The touch offset of a node for a tool that counts depths from its nominal height.
double touch_offset_m(const NodeRows& rows, std::int64_t row) {
  const ToolShape& tool = rows.table.tool;
  const double offset_m = rows.table.touch_offset_m[static_cast<std::size_t>(row)];
  if (tool.kind == "sphere") {
    return offset_m;
  }
  const double height_m = height_at_touch_m(tool, rows.normal.row(row).transpose());
  if (!std::isfinite(height_m)) {
    throw InputError(
        fmt::format("tool {:?}: a {} without end lies below its own tip at node {} of "
                    "the surface; its axis must lean away from it",
                    tool.name, tool.kind, row));
  }
  return offset_m + nominal_height_m(tool) - height_m;
}

// Without a stored line that of the direction.
TiltLine stored_tilt(const ResponseTable& table, std::int64_t row,
                     const Eigen::Vector3d& outward) {
  if (table.tilt.rows() > 0) {
    return tilt_line(table, row, outward);
  }
  const Eigen::Vector3d direction = table.direction.row(row).transpose();
  return limited(tilt_line(direction, outward), 0.0, 0.0, 0.0);
}

// By the height of the tool, d' = height at touch - touch offset - height.
void set_tilt(ElementNode& message, const NodeRows& rows, std::int64_t row) {
  const ResponseTable& table = rows.table;
  const Eigen::Vector3d outward = rows.normal.row(row).transpose();
  const TiltLine line = rows.tilt.empty() ? stored_tilt(table, row, outward)
                                          : rows.tilt[static_cast<std::size_t>(row)];
  const Eigen::Vector3d at_no_height =
      line.at(nominal_height_m(table.tool) - message.touch_offset_m);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    message.tilt[i] = at_no_height(axis);
    message.tilt_by_height_per_m[i] = -line.by_depth_per_m(axis);
  }
}

// A node whose stiffness nobody knows beside others that know theirs has that of its
// presliding length at the last depth, S = mu d / delta_L.
void set_lateral(ElementNode& message, const ResponseTable& table, std::int64_t row) {
  if (!table.contact.has_lateral() || !(message.friction > 0.0)) {
    return;
  }
  const auto stored = table.contact.lateral.row(row);
  const double alike =
      message.friction * table.curve(row).depth_m.back() / message.presliding_m;
  for (std::size_t i = 0; i < message.lateral.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    message.lateral[i] = stored(0) > 0.0F ? static_cast<double>(stored(column))
                                          : (i % 3 == 1 ? 0.0 : alike);
  }
}

}  // namespace

std::array<double, 3> row_array(const Points& points, Eigen::Index row) {
  return {points(row, 0), points(row, 1), points(row, 2)};
}

ElementNode node_message(const NodeRows& rows, std::int64_t row, double* loss_n) {
  const ResponseTable& table = rows.table;
  const auto i = static_cast<std::size_t>(row);
  ElementNode message;
  message.position_m = row_array(rows.position_m, row);
  message.normal = row_array(rows.normal, row);
  message.friction = table.friction[i];
  message.presliding_m = table.presliding_m[i];
  const CurveView curve = table.curve(row);
  if (curve.depth_m.empty()) {
    return message;
  }
  message.touch_offset_m = touch_offset_m(rows, row);
  message.direction = row_array(table.direction, row);
  set_tilt(message, rows, row);
  set_lateral(message, table, row);
  const double lost_n = set_curve(message, curve) * rows.force_scale;
  if (loss_n != nullptr) {
    *loss_n = lost_n;
  }
  // Force, slope and energy scale together: a softer body with the same depths and
  // directions.
  for (std::size_t k = 0; k < static_cast<std::size_t>(message.samples); ++k) {
    message.force_n[k] *= rows.force_scale;
    message.stiffness_n_per_m[k] *= rows.force_scale;
    message.energy_j[k] *= rows.force_scale;
  }
  return message;
}

std::unordered_map<std::int32_t, ElementNode> thinned_messages(const NodeRows& rows,
                                                               ResampleLoss& loss) {
  std::unordered_map<std::int32_t, ElementNode> thinned;
  for (std::int32_t i = 0; i < rows.table.nodes(); ++i) {
    const CurveView curve = rows.table.curve(i);
    if (curve.depth_m.size() <= kElementSamples) {
      continue;
    }
    double loss_n = 0.0;
    thinned.emplace(i, node_message(rows, i, &loss_n));
    const double force_max =
        std::abs(*std::max_element(curve.force_n.begin(), curve.force_n.end()));
    loss.nodes += 1;
    loss.force_n = std::max(loss.force_n, loss_n);
    if (force_max > 0.0) {
      loss.force_relative = std::max(loss.force_relative, loss_n / force_max);
    }
  }
  return thinned;
}

WantedTriangles wanted_triangles(const SurfaceSearch& search, std::int32_t active,
                                 std::int32_t in_use) noexcept {
  WantedTriangles wanted;
  wanted.triangle[0] = active;
  const std::span<std::int32_t> around = std::span(wanted.triangle).subspan(1);
  const std::size_t ring = search.around(active, around);
  wanted.count = 1 + ring;
  const auto end = around.begin() + static_cast<std::ptrdiff_t>(ring);
  if (in_use >= 0 && in_use != active &&
      std::find(around.begin(), end, in_use) == end) {
    // The three edges of the other element take the places of the last of the ring.
    const std::size_t kept = std::min(ring, kNeighboursMax - 3);
    wanted.count = 1 + kept + search.around(in_use, around.subspan(kept, 3));
  }
  return wanted;
}

}  // namespace palpate
