#include "formats/response/tilt_line.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "formats/response/response_table.h"

namespace palpate {
namespace {

// What rounding leaves of limits.
constexpr double kTiltRounding = 1e-9;
// A force that lies in the tangent plane has no tilt; its limit has.
constexpr double kLeastNormal = 1e-9;

Eigen::Vector3d along_surface(const Eigen::Vector3d& v, const Eigen::Vector3d& n) {
  return v - v.dot(n) * n;
}

// |u . n|, how much of the displacement a curve counts.
double along_normal(const ResponseTable& table, std::int64_t node,
                    const Eigen::Vector3d& outward) {
  return std::abs(table.direction.row(node).dot(outward.transpose()));
}

// Half of the interval to each side.
double trapezoid(std::span<const double> x, std::size_t k) {
  const std::size_t before = k > 0 ? k - 1 : k;
  const std::size_t after = std::min(k + 1, x.size() - 1);
  return 0.5 * (x[after] - x[before]);
}

// Share of the slope that keeps |middle + share slope| <= kTiltMost.
double share_within(const Eigen::Vector3d& middle, const Eigen::Vector3d& change) {
  const double a = change.squaredNorm();
  const double b = middle.dot(change);
  const double room = std::max(0.0, kTiltMost * kTiltMost - middle.squaredNorm());
  if (a + 2.0 * b <= room) {
    return 1.0;
  }
  return std::clamp((std::sqrt(b * b + a * room) - b) / a, 0.0, 1.0);
}

TiltLine line_of_samples(const ResponseTable& table, std::int64_t node,
                         const Eigen::Vector3d& outward) {
  const CurveView curve = table.curve(node);
  const std::int64_t row = table.direction_begin[static_cast<std::size_t>(node)];
  const double along = along_normal(table, node, outward);
  std::vector<double> past_touch_m;
  Points force_n(static_cast<Eigen::Index>(curve.depth_m.size()), 3);
  for (std::size_t k = 0; k < curve.depth_m.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    past_touch_m.push_back(curve.depth_m[k] / along);
    force_n.row(i) = curve.force_n[k] * table.sample_direction.row(row + i);
  }
  return tilt_line(past_touch_m, force_n, outward);
}

}  // namespace

TiltLine tilt_line(const Eigen::Vector3d& direction, const Eigen::Vector3d& outward) {
  const double normal = std::abs(direction.dot(outward));
  return {.tilt = along_surface(direction, outward) /
                  std::max(normal, kLeastNormal * direction.norm())};
}

TiltLine tilt_line(std::span<const double> past_touch_m, const Points& force_n,
                   const Eigen::Vector3d& outward) {
  const auto force = [&](std::size_t k) -> Eigen::Vector3d {
    return force_n.row(static_cast<Eigen::Index>(k)).transpose();
  };
  // Weights and the mean force: sum w = sum N h, F = sum F h.
  std::vector<double> weight(past_touch_m.size(), 0.0);
  double sum = 0.0;
  double moment = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < weight.size(); ++k) {
    const double h = trapezoid(past_touch_m, k);
    weight[k] = h * std::max(0.0, force(k).dot(outward));
    sum += weight[k];
    moment += weight[k] * past_touch_m[k];
    mean += weight[k] > 0.0 ? (h * force(k)).eval() : Eigen::Vector3d::Zero().eval();
  }
  if (!(sum > 0.0)) {
    return {};
  }
  // Slope: sum w (d' - middle) theta / sum w (d' - middle)^2, with w theta = F_t h.
  const double middle = moment / sum;
  double spread = 0.0;
  Eigen::Vector3d turning = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < weight.size(); ++k) {
    const double off = past_touch_m[k] - middle;
    spread += weight[k] * off * off;
    if (weight[k] > 0.0) {
      turning += trapezoid(past_touch_m, k) * off * along_surface(force(k), outward);
    }
  }
  TiltLine line = tilt_line(mean, outward);
  const double reach = past_touch_m.back() - past_touch_m.front();
  if (spread > kTiltRounding * sum * reach * reach) {
    line.by_depth_per_m = turning / spread;
    line.tilt -= middle * line.by_depth_per_m;
  }
  return line;
}

TiltRange tilt_range(const CurveView& curve, double along) {
  if (curve.depth_m.empty() || !(along > 0.0)) {
    return {};
  }
  double sum = 0.0;
  double moment = 0.0;
  for (std::size_t k = 0; k < curve.depth_m.size(); ++k) {
    const double weight = trapezoid(curve.depth_m, k) * curve.force_n[k];
    sum += weight;
    moment += weight * curve.depth_m[k];
  }
  return {.middle_m = sum > 0.0 ? moment / sum / along : 0.0,
          .end_m = curve.depth_max_m() / along};
}

TiltRange tilt_range(const ResponseTable& table, std::int64_t node,
                     const Eigen::Vector3d& outward) {
  return tilt_range(table.curve(node), along_normal(table, node, outward));
}

bool is_within_limits(const TiltLine& line, double end_m, double longest_edge_m) {
  constexpr double kRoom = 1.0 + 1e-6;  // curves may have been stored as binary32
  return line.tilt.norm() <= kTiltMost * kRoom &&
         line.at(end_m).norm() <= kTiltMost * kRoom &&
         line.by_depth_per_m.norm() * longest_edge_m <= kTiltChangeMost * kRoom;
}

TiltLine limited(const TiltLine& line, double middle_m, double end_m,
                 double longest_edge_m) {
  if (is_within_limits(line, end_m, longest_edge_m)) {
    return line;
  }
  Eigen::Vector3d middle = line.at(middle_m);
  middle *= std::min(1.0, kTiltMost / std::max(kTiltMost, middle.norm()));
  Eigen::Vector3d slope = line.by_depth_per_m;
  slope *= kTiltChangeMost / std::max(kTiltChangeMost, slope.norm() * longest_edge_m);
  // The length of a line's value is largest at one of its ends.
  slope *= std::min(share_within(middle, -middle_m * slope),
                    share_within(middle, (end_m - middle_m) * slope));
  return {.tilt = middle - middle_m * slope, .by_depth_per_m = slope};
}

TiltLine tilt_line(const ResponseTable& table, std::int64_t node,
                   const Eigen::Vector3d& outward, double longest_edge_m) {
  const auto i = static_cast<std::size_t>(node);
  if (table.curve(node).depth_m.empty()) {
    return {};
  }
  const TiltRange range = tilt_range(table, node, outward);
  TiltLine line;
  if (table.tilt.rows() > 0) {
    line = {.tilt = table.tilt.row(node).transpose(),
            .by_depth_per_m = table.tilt_by_depth_per_m.row(node).transpose()};
  } else if (!table.direction_begin.empty() &&
             table.direction_begin[i + 1] > table.direction_begin[i] &&
             range.end_m > 0.0) {
    line = line_of_samples(table, node, outward);
  } else {
    line = tilt_line(table.direction.row(node).transpose().eval(), outward);
  }
  return limited(line, range.middle_m, range.end_m, longest_edge_m);
}

std::vector<double> longest_edges_m(const SurfaceMesh& mesh) {
  std::vector<double> longest(static_cast<std::size_t>(mesh.position_m.rows()), 0.0);
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      const std::int32_t a = mesh.triangle(t, j);
      const std::int32_t b = mesh.triangle(t, (j + 1) % 3);
      const double edge_m = (mesh.position_m.row(a) - mesh.position_m.row(b)).norm();
      for (const std::int32_t end : {a, b}) {
        double& most = longest[static_cast<std::size_t>(end)];
        most = std::max(most, edge_m);
      }
    }
  }
  return longest;
}

Eigen::Vector3d tilted(const Eigen::Vector3d& outward, const Eigen::Vector3d& tilt) {
  return (outward + tilt).normalized();
}

bool limit_tilt(NodeResponse& response, const Eigen::Vector3d& outward,
                double longest_edge_m) {
  if (!response.tilt) {
    return false;
  }
  const TiltRange range = tilt_range({response.depth_m, response.force_n, {}, {}},
                                     std::abs(response.direction.dot(outward)));
  if (is_within_limits(*response.tilt, range.end_m, longest_edge_m)) {
    return false;
  }
  const TiltLine line = *response.tilt;
  response.tilt = limited(line, range.middle_m, range.end_m, longest_edge_m);
  double lost = 0.0;
  for (const double at_m : {0.0, range.end_m}) {
    lost = std::max(lost, (tilted(outward, line.at(at_m)) -
                           tilted(outward, response.tilt->at(at_m)))
                              .norm());
  }
  response.error_relative = std::hypot(response.error_relative, lost);
  return true;
}

}  // namespace palpate
