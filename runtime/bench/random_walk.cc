#include "runtime/bench/random_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "formats/response/tool_support.h"
#include "runtime/hand/press_site.h"

namespace palpate {

Wanderer::Wanderer(const ResponseDatabase& database, const ResponseTable& table,
                   const DatabaseWalkOptions& options)
    : database_(database),
      table_(table),
      o_(options),
      random_(options.seed),
      search_(database.body) {
  const std::int32_t node = node_to_press(database, table, std::nullopt);
  x_ = database.body.position_m.row(node).transpose() +
       (nominal_height_m(table.tool) + o_.lift_m) *
           database.normal.row(node).transpose();
  triangle_ = search_.nearest(x_).triangle;
}

Eigen::Vector3d Wanderer::step(double tick_s) {
  std::normal_distribution<double> normal;
  const double decay = tick_s / o_.memory_s;
  const double noise = o_.speed_m_per_s * std::sqrt(2.0 * decay);
  const Eigen::Vector3d from = x_;
  for (int i = 0; i < 3; ++i) {
    v_(i) += -decay * v_(i) + noise * normal(random_);
  }
  x_ += tick_s * v_;
  const SurfacePoint at = search_.walk(x_, triangle_);
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  double depth_max = std::numeric_limits<double>::infinity();
  for (Eigen::Index j = 0; j < 3; ++j) {
    const std::int32_t node = database_.body.triangle(at.triangle, j);
    n += at.area_coordinate(j) * database_.normal.row(node).transpose();
    const CurveView curve = table_.curve(node);
    depth_max = curve.depth_m.empty() ? -1.0 : std::min(depth_max, curve.depth_max_m());
    if (curve.depth_m.empty()) {
      break;
    }
  }
  if (!(depth_max > 0.0)) {  // out of reach: back
    x_ = from;
    v_ = -v_;
    return x_;
  }
  n.normalize();
  triangle_ = at.triangle;
  const double height = (x_ - at.position_m).dot(n) - nominal_height_m(table_.tool);
  const double kept = std::clamp(height, -o_.depth_share * depth_max, o_.lift_m);
  if (kept != height) {
    x_ += (kept - height) * n;
    v_ -= 2.0 * v_.dot(n) * n;
  }
  return x_;
}

}  // namespace palpate
