#include "runtime/slow/node_memory.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "formats/response/yielding.h"

namespace palpate {
namespace {

static_assert(kMemoryTerms == kMostTerms && kNodeSites == kMostNodeSites &&
              kMemoryBundles == kMostBundles);

// Least slope of an interval's cubic from one depth to another within it.
double least_slope(const CurveView& curve, std::size_t i, double from, double to) {
  double least = std::min(curve.inside(i, from).stiffness_n_per_m,
                          curve.inside(i, to).stiffness_n_per_m);
  // The slope is m0 + 2 b x + 3 c x^2, with x from 0 to 1 of the interval.
  const double h = curve.depth_m[i + 1] - curve.depth_m[i];
  const double secant = (curve.force_n[i + 1] - curve.force_n[i]) / h;
  const double m0 = curve.stiffness_n_per_m[i];
  const double m1 = curve.stiffness_n_per_m[i + 1];
  const double b = 3.0 * secant - 2.0 * m0 - m1;
  const double c = m0 + m1 - 2.0 * secant;
  const double lowest = curve.depth_m[i] - h * b / (3.0 * c);
  if (c > 0.0 && lowest > from && lowest < to) {
    least = std::min(least, curve.inside(i, lowest).stiffness_n_per_m);
  }
  return least;
}

// Of the curve between two depths, its last slope going on.
double least_slope(const CurveView& curve, double from, double to) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < curve.depth_m.size(); ++i) {
    const double low = std::max(from, curve.depth_m[i]);
    const double high = std::min(to, curve.depth_m[i + 1]);
    if (low <= high) {
      least = std::min(least, least_slope(curve, i, low, high));
    }
  }
  return to > curve.depth_m.back()
             ? std::min(least, std::max(0.0, curve.stiffness_n_per_m.back()))
             : least;
}

// Of a node without a response, too: places beside it blend it with others.
void set_yielding(const Yielding& yielding, std::int64_t row, NodeMemory& memory) {
  if (yielding.empty()) {
    return;
  }
  const NodeYielding node = yielding_of(yielding, row);
  memory.yield_depth_m = node.yield_depth_m;
  memory.dent_share = node.share;
  memory.onset_m = node.onset_m;
  memory.soft_scale_m = node.scale_m;
  memory.soft_most = node.largest;
}

bool falls(const CurveView& curve) {
  return !std::is_sorted(curve.force_n.begin(), curve.force_n.end());
}

}  // namespace

ElementMemory tool_memory(const Viscoelasticity& relaxation) noexcept {
  ElementMemory memory;
  memory.terms = static_cast<std::int32_t>(relaxation.terms());
  memory.bundles = static_cast<std::int32_t>(relaxation.bundles());
  memory.yields = !relaxation.yielding.empty();
  std::copy(relaxation.tau_s.begin(), relaxation.tau_s.end(),
            memory.relaxation_s.begin());
  return memory;
}

NodeMemory node_memory(const Viscoelasticity& relaxation, std::int64_t row,
                       const ElementNode& node) {
  NodeMemory memory;
  set_yielding(relaxation.yielding, row, memory);
  if (node.samples == 0 && relaxation.yielding.empty()) {
    return memory;
  }
  if (node.samples > 0 && !relaxation.empty()) {
    const Eigen::RowVectorXd g = relaxation.shares(row);
    // Shares are stored in single precision, whose sums may exceed 1 in the last place.
    const double most = std::max(1.0, g.sum());
    for (Eigen::Index k = 0; k < g.size(); ++k) {
      memory.relaxing[static_cast<std::size_t>(k)] = g[k] / most;
    }
  }
  const MemorySites& sites = relaxation.sites;
  if (sites.empty()) {
    memory.site[0] = node.node;
    memory.weight[0] = 1.0;
  } else {
    const double sum = sites.weight.row(row).cast<double>().sum();
    for (std::size_t k = 0; k < kNodeSites && sum > 0.0; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      memory.site[k] = sites.site(row, column);
      memory.weight[k] = static_cast<double>(sites.weight(row, column)) / sum;
    }
  }
  if (node.samples > 0 && relaxation.bundles() > 1) {
    const std::array<double, kMemoryBundles - 1> cuts_m =
        bundle_cuts_m(node.curve(), relaxation.bundle_depth_m);
    std::copy(cuts_m.begin(), cuts_m.end(), memory.cut_m.begin());
  }
  return memory;
}

std::array<double, kMemoryBundles - 1> bundle_cuts_m(
    const CurveView& curve, const std::vector<double>& depth_m) {
  std::array<double, kMemoryBundles - 1> cuts_m{};
  // Beyond the last sample the slope stays: a bundle that begins there has no force.
  double next_m = 2.0 * curve.depth_m.back();
  cuts_m.fill(next_m);
  if (falls(curve)) {
    return cuts_m;
  }
  for (std::size_t b = depth_m.size(); b-- > 0;) {
    const double at_m = depth_m[b];
    if (at_m < next_m && least_slope(curve, at_m, next_m) >=
                             curve.at(at_m).stiffness_n_per_m * (1.0 - 1e-9)) {
      next_m = at_m;
    }
    cuts_m[b] = next_m;
  }
  return cuts_m;
}

}  // namespace palpate
