#include "formats/response/response_table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/response_curve.h"
#include "formats/response/response_rules.h"

namespace palpate {
namespace {

void append_curve(ResponseTable& table, const NodeResponse& response,
                  std::size_t node) {
  const std::string broken = broken_rule(response);
  if (!broken.empty()) {
    throw InputError(fmt::format("node {}: {}", node, broken));
  }
  try {
    const ResponseCurve curve(response.depth_m, response.force_n);
    const CurveView view = curve.view();
    const auto append = [](std::vector<double>& to, std::span<const double> from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(table.depth_m, view.depth_m);
    append(table.force_n, view.force_n);
    append(table.stiffness_n_per_m, view.stiffness_n_per_m);
    append(table.energy_j, view.energy_j);
    table.stiffness_max_n_per_m.back() = curve.stiffness_max_n_per_m();
    if (curve.falls()) {
      table.flags.back() |= kFallingCurve;
    }
  } catch (const InputError& error) {
    throw InputError(fmt::format("node {}: {}", node, error.what()));
  }
}

// Rows of `sample_direction` for the nodes that have them; nothing where none has.
void fill_sample_directions(ResponseTable& table,
                            const std::vector<NodeResponse>& responses) {
  std::vector<Eigen::Vector3d> rows;
  table.direction_begin.push_back(0);
  for (const NodeResponse& response : responses) {
    rows.insert(rows.end(), response.sample_direction.begin(),
                response.sample_direction.end());
    table.direction_begin.push_back(static_cast<std::int64_t>(rows.size()));
  }
  if (rows.empty()) {
    table.direction_begin.clear();
  }
  table.sample_direction.resize(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    table.sample_direction.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  }
}

}  // namespace

CurveView ResponseTable::curve(std::int64_t node) const noexcept {
  const auto i = static_cast<std::size_t>(node);
  const auto begin = static_cast<std::size_t>(sample_begin[i]);
  const auto count = static_cast<std::size_t>(sample_begin[i + 1]) - begin;
  return {std::span(depth_m).subspan(begin, count),
          std::span(force_n).subspan(begin, count),
          std::span(stiffness_n_per_m).subspan(begin, count),
          std::span(energy_j).subspan(begin, count)};
}

double ResponseTable::depth_max_m() const noexcept {
  return depth_m.empty() ? 0.0 : *std::max_element(depth_m.begin(), depth_m.end());
}

ResponseTable make_table(const ToolShape& tool,
                         const std::vector<NodeResponse>& responses) {
  const std::size_t n = responses.size();
  ResponseTable table;
  table.tool = tool;
  table.direction = Points::Zero(static_cast<Eigen::Index>(n), 3);
  table.friction.assign(n, tool.friction);
  table.presliding_m.assign(n, tool.presliding_m);
  table.sample_begin.push_back(0);
  for (std::size_t i = 0; i < n; ++i) {
    const NodeResponse& response = responses[i];
    table.direction_spread_rad.push_back(response.direction_spread_rad);
    table.touch_offset_m.push_back(response.touch_offset_m);
    table.error_relative.push_back(response.error_relative);
    table.origin.push_back(static_cast<std::uint8_t>(response.origin));
    table.flags.push_back(response.flags);
    table.stiffness_max_n_per_m.push_back(0.0);
    if (response.origin != ResponseOrigin::kNone) {
      table.direction.row(static_cast<Eigen::Index>(i)) =
          response.direction.transpose();
      append_curve(table, response, i);
    }
    table.sample_begin.push_back(static_cast<std::int64_t>(table.depth_m.size()));
  }
  fill_sample_directions(table, responses);
  return table;
}

Eigen::Vector3d area_coordinates(const Eigen::Matrix3d& corner_m,
                                 const Eigen::Vector3d& p_m) noexcept {
  const Eigen::Vector3d a = corner_m.row(0).transpose();
  const Eigen::Vector3d e1 = corner_m.row(1).transpose() - a;
  const Eigen::Vector3d e2 = corner_m.row(2).transpose() - a;
  const Eigen::Vector3d normal = e1.cross(e2);
  const double scale = normal.squaredNorm();
  if (!(scale > 0.0)) {
    return {1.0, 0.0, 0.0};
  }
  const Eigen::Vector3d r = p_m - a;
  const double n1 = r.cross(e2).dot(normal) / scale;
  const double n2 = e1.cross(r).dot(normal) / scale;
  return {1.0 - n1 - n2, n1, n2};
}

InterpolatedResponse interpolate(const ResponseTable& table, const Points& normal,
                                 const Eigen::Vector3i& node,
                                 const Eigen::Vector3d& area_coordinate,
                                 double depth_m) noexcept {
  InterpolatedResponse response;
  for (int j = 0; j < 3; ++j) {
    const Eigen::Index i = node[j];
    const double weight = area_coordinate[j];
    const Eigen::Vector3d u = table.direction.row(i).transpose();
    const double along = std::abs(normal.row(i).dot(u.transpose()));
    const double offset = table.touch_offset_m[static_cast<std::size_t>(i)] * along;
    const ResponseSample sample = table.curve(i).at(depth_m - offset);
    response.direction += weight * u;
    response.force_n += weight * sample.force_n;
    response.stiffness_n_per_m += weight * sample.stiffness_n_per_m;
    response.energy_j += weight * sample.energy_j;
    response.extrapolated = response.extrapolated || sample.extrapolated;
  }
  const double length = response.direction.norm();
  if (length > 0.0) {
    response.direction /= length;
  }
  return response;
}

}  // namespace palpate
