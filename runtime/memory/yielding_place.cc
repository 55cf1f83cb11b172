#include "runtime/memory/yielding_place.h"

#include <cmath>
#include <cstddef>
#include <limits>

namespace palpate {
namespace {

Turned<Real> blend(const std::array<Real, 3>& value, const NodeValues& weight,
                   const Turn& turn) {
  const Vector3 v(value[0], value[1], value[2]);
  return {v.dot(weight.head<3>().matrix()), v.dot(turn.col(0)), v.dot(turn.col(1)),
          v.dot(turn.col(2))};
}

}  // namespace

YieldingNodes make_yielding_nodes(const ElementMemory& memory,
                                  const PlaceNodes& nodes) noexcept {
  YieldingNodes yielding;
  yielding.any = memory.yields;
  yielding.first_onset_m = std::numeric_limits<Real>::infinity();
  for (std::size_t j = 0; j < 3 && yielding.any; ++j) {
    const NodeMemory& node = memory.node[j];
    const Real c = nodes.lean[j] > 0.0 ? nodes.lean[j] : Real(1.0);
    yielding.yield_m[j] = nodes.touch_m[j] + node.yield_depth_m / c;
    yielding.share[j] = node.dent_share;
    yielding.onset_m[j] = nodes.touch_m[j] + node.onset_m / c;
    yielding.rate_per_m[j] = c / node.soft_scale_m;
    yielding.most[j] = node.soft_most;
    if (node.soft_most > 0.0) {
      yielding.softens = true;
      yielding.first_onset_m = std::min(yielding.first_onset_m, yielding.onset_m[j]);
    }
  }
  return yielding;
}

void locate(YieldingPlace& place, const YieldingNodes& nodes, const NodeValues& weight,
            const Turn& turn) noexcept {
  place.yield_m = blend(nodes.yield_m, weight, turn);
  place.share = blend(nodes.share, weight, turn);
  place.stretch = Real(1.0) / (Real(1.0) - place.share.value);
}

void soften(const YieldingPlace& place, const YieldingNodes& nodes, NodeValues& weight,
            Turn& turn) noexcept {
  if (!nodes.softens) {
    return;
  }
  const Turned<Real>& m = place.softened_m;
  for (std::size_t j = 0; j < 3; ++j) {
    const Real x = (m.value - nodes.onset_m[j]) * nodes.rate_per_m[j];
    if (x > 0.0 && nodes.most[j] > 0.0) {
      const auto row = static_cast<Eigen::Index>(j);
      const Real left = nodes.most[j] * std::exp(-x);
      const Real whole = Real(1.0) - nodes.most[j] + left;  // 1 - omega
      turn.row(row) =
          whole * turn.row(row) -
          (weight(row) * left * nodes.rate_per_m[j]) * slope_of(m).transpose();
      weight(row) *= whole;
    }
  }
}

Vector3 stored_slope_j(const YieldingPlace& place, const PlacePoint& at,
                       const PlacePoint& at_yield, Real l_m,
                       const Turn& turn) noexcept {
  const auto along = [&turn](const PlacePoint& point) -> Vector3 {
    return turn.transpose() * point.node_j.head<3>().matrix();
  };
  const Real r = place.share_at(l_m);
  if (!(r > 0.0)) {
    return along(at);
  }
  const Real past_j =
      at_yield.energy_j - at.energy_j + at.force_n * (l_m - place.yield_m.value);
  return r * along(at_yield) + (Real(1.0) - r) * along(at) +
         past_j * slope_of(place.share) +
         (r * (at_yield.force_n - at.force_n)) * slope_of(place.yield_m);
}

}  // namespace palpate
