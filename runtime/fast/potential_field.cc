#include "runtime/fast/potential_field.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpate {
namespace {

// c_j: how far the tool moves along u for each unit along the normal.
double lean(const ElementNode& node) {
  const Eigen::Map<const Eigen::Vector3d> n(node.normal.data());
  const Eigen::Map<const Eigen::Vector3d> u(node.direction.data());
  return std::abs(n.dot(u));
}

}  // namespace

FieldResponse respond(const FieldPlace& place, const ElementCache& cache,
                      double tool_radius_m, double shift_m,
                      CurvePieces& pieces) noexcept {
  FieldResponse response;
  if (place.slot < 0) {
    return response;
  }
  turn_to(pieces, cache, place.slot);
  const Element& element = cache.element[static_cast<std::size_t>(place.slot)];
  response.depth_m = tool_radius_m - place.at.height_m;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  // dU by n_1 and n_2 [J]
  for (std::size_t j = 0; j < 3; ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    const ElementNode& node = element.node[j];
    if (node.samples == 0) {
      continue;
    }
    const double weight = std::max(0.0, place.frame.weight(row));
    const double past = response.depth_m - node.touch_offset_m;
    response.touching = response.touching || (past > 0.0 && weight > 0.0);
    if (!(past - shift_m > 0.0)) {
      continue;
    }
    const double c = lean(node);
    const ResponseSample at = evaluate(pieces, node, j, c * (past - shift_m));
    response.loaded = response.loaded || weight > 0.0;
    response.extrapolated = response.extrapolated || (at.extrapolated && weight > 0.0);
    response.normal_n += weight * c * at.force_n;
    response.stiffness_n_per_m += weight * c * c * at.stiffness_n_per_m;
    response.energy_j += weight * at.energy_j;
    slope += place.frame.turn.row(row).transpose() * at.energy_j;
  }
  if (place.folded) {
    response.force_n = response.normal_n * place.frame.normal;
  } else if (response.loaded) {
    response.force_n = -gradient(place.frame, slope(0), slope(1), -response.normal_n);
  }
  return response;
}

double unloading_shift_m(const FieldPlace& place, const ElementCache& cache,
                         double tool_radius_m) noexcept {
  const Element& element = cache.element[static_cast<std::size_t>(place.slot)];
  double touch = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < 3; ++j) {
    if (element.node[j].samples > 0) {
      touch = std::min(touch, element.node[j].touch_offset_m);
    }
  }
  return std::isfinite(touch) ? std::max(0.0, tool_radius_m - place.at.height_m - touch)
                              : 0.0;
}

}  // namespace palpate
