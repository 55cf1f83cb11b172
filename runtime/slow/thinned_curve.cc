#include "runtime/slow/thinned_curve.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <vector>

namespace palpate {
namespace {

// Samples begin and end of a curve as one cubic between them.
struct Interval {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t worst = 0;  // sample between them with the largest error
  double error_n = 0.0;
  bool operator<(const Interval& other) const { return error_n < other.error_n; }
};

Interval measure(const CurveView& curve, std::size_t begin, std::size_t end) {
  Interval interval{.begin = begin, .end = end, .worst = begin};
  const double depth[] = {curve.depth_m[begin], curve.depth_m[end]};
  const double force[] = {curve.force_n[begin], curve.force_n[end]};
  const double slope[] = {curve.stiffness_n_per_m[begin], curve.stiffness_n_per_m[end]};
  const double energy[] = {0.0, 0.0};
  const CurveView cubic{depth, force, slope, energy};
  for (std::size_t i = begin + 1; i < end; ++i) {
    const double error =
        std::abs(cubic.at(curve.depth_m[i]).force_n - curve.force_n[i]);
    if (error > interval.error_n) {
      interval.error_n = error;
      interval.worst = i;
    }
  }
  return interval;
}

std::vector<std::size_t> choose_samples(const CurveView& curve, std::size_t count) {
  std::vector<std::size_t> kept = {0, curve.depth_m.size() - 1};
  std::priority_queue<Interval> open;
  open.push(measure(curve, kept.front(), kept.back()));
  while (kept.size() < count && open.top().error_n > 0.0) {
    const Interval widest = open.top();
    open.pop();
    kept.push_back(widest.worst);
    open.push(measure(curve, widest.begin, widest.worst));
    open.push(measure(curve, widest.worst, widest.end));
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

void set_samples(ElementNode& node, const CurveView& curve,
                 const std::vector<std::size_t>& kept) {
  const std::size_t n = kept.size();
  node.samples = static_cast<std::int32_t>(n);
  for (std::size_t i = 0; i < n; ++i) {
    node.depth_m[i] = curve.depth_m[kept[i]];
    node.force_n[i] = curve.force_n[kept[i]];
    node.stiffness_n_per_m[i] = curve.stiffness_n_per_m[kept[i]];
  }
  node.energy_j[0] = 0.0;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double h = node.depth_m[i + 1] - node.depth_m[i];
    const double secant = (node.force_n[i + 1] - node.force_n[i]) / h;
    node.stiffness_n_per_m[i] = monotone_slope(node.stiffness_n_per_m[i], secant);
    node.stiffness_n_per_m[i + 1] =
        monotone_slope(node.stiffness_n_per_m[i + 1], secant);
  }
  for (std::size_t i = 0; i + 1 < n; ++i) {
    // Exact integral of the Hermite cubic over the interval.
    const double h = node.depth_m[i + 1] - node.depth_m[i];
    node.energy_j[i + 1] =
        node.energy_j[i] + h * (node.force_n[i] + node.force_n[i + 1]) / 2.0 +
        h * h * (node.stiffness_n_per_m[i] - node.stiffness_n_per_m[i + 1]) / 12.0;
  }
}

}  // namespace

double monotone_slope(double slope, double secant) noexcept {
  if (!(slope * secant > 0.0)) {
    return 0.0;
  }
  return std::copysign(std::min(std::abs(slope), 3.0 * std::abs(secant)), slope);
}

double set_curve(ElementNode& node, const CurveView& curve) {
  const std::size_t n = curve.depth_m.size();
  if (n <= kElementSamples) {
    node.samples = static_cast<std::int32_t>(n);
    std::copy(curve.depth_m.begin(), curve.depth_m.end(), node.depth_m.begin());
    std::copy(curve.force_n.begin(), curve.force_n.end(), node.force_n.begin());
    std::copy(curve.stiffness_n_per_m.begin(), curve.stiffness_n_per_m.end(),
              node.stiffness_n_per_m.begin());
    std::copy(curve.energy_j.begin(), curve.energy_j.end(), node.energy_j.begin());
    return 0.0;
  }
  set_samples(node, curve, choose_samples(curve, kElementSamples));
  double loss = 0.0;
  for (std::size_t i = 1; i < n; ++i) {
    for (const double d :
         {curve.depth_m[i], 0.5 * (curve.depth_m[i - 1] + curve.depth_m[i])}) {
      loss = std::max(loss, std::abs(node.curve().at(d).force_n - curve.at(d).force_n));
    }
  }
  return loss;
}

}  // namespace palpate
