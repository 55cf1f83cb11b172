#include "formats/response/yielding.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

#include <fmt/format.h>

#include "formats/base/reproducible.h"
#include "formats/response/response_curve.h"

namespace palpate {
namespace {

// Samples of an undamaged curve: what an element message holds.
constexpr std::size_t kSamples = 48;
// Before the onset, over the scale: the slope jumps there.
constexpr double kBeforeOnset = 1e-6;

// 1 - omega, as the fast step has it.
double share_left(const NodeYielding& node, double deepest_m) {
  const double past = deepest_m - node.onset_m;
  return past > 0.0 ? 1.0 - node.largest +
                          node.largest * reproducible::exp(-past / node.scale_m)
                    : 1.0;
}

// f / (1 - omega) at a depth, and its slope on the deeper side.
ResponseSample undamaged(const CurveView& curve, const NodeYielding& node, double d) {
  const ResponseSample at = curve.at(d);
  const double left = share_left(node, d);
  const double growing =
      d < node.onset_m ? 0.0
                       : node.largest / node.scale_m *
                             reproducible::exp(-(d - node.onset_m) / node.scale_m);
  return {at.force_n / left,
          (at.stiffness_n_per_m + at.force_n * growing / left) / left, 0.0, false};
}

// Depths of the samples, and between them where the intervals past the onset are
// longest.
std::vector<double> depths_of(const CurveView& curve, const NodeYielding& node) {
  std::vector<double> depth_m(curve.depth_m.begin(), curve.depth_m.end());
  // The slope of f / (1 - omega) jumps at the onset: a sample on either side of it.
  for (const double d : {node.onset_m - kBeforeOnset * node.scale_m, node.onset_m}) {
    if (d > 0.0 && d < depth_m.back() &&
        !std::binary_search(depth_m.begin(), depth_m.end(), d)) {
      depth_m.insert(std::upper_bound(depth_m.begin(), depth_m.end(), d), d);
    }
  }
  // The widest interval past the onset is halved until a message is full.
  while (depth_m.size() < kSamples) {
    std::size_t widest = 0;
    double width_m = 0.0;
    for (std::size_t i = 0; i + 1 < depth_m.size(); ++i) {
      const double width = depth_m[i + 1] - depth_m[i];
      if (depth_m[i] >= node.onset_m && width > width_m) {
        widest = i;
        width_m = width;
      }
    }
    if (!(width_m > kBeforeOnset * node.scale_m)) {
      break;
    }
    depth_m.insert(depth_m.begin() + static_cast<std::ptrdiff_t>(widest) + 1,
                   0.5 * (depth_m[widest] + depth_m[widest + 1]));
  }
  return depth_m;
}

double of_node(const std::vector<double>& rows, std::int64_t node, double none) {
  return rows.empty() ? none : row_of(rows, node);
}

std::string range_text(const std::vector<double>& values, double scale) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *low == *high ? fmt::format("{:.3g}", scale * *low)
                       : fmt::format("{:.3g} to {:.3g}", scale * *low, scale * *high);
}

}  // namespace

NodeYielding yielding_of(const Yielding& yielding, std::int64_t node) {
  return {.yield_depth_m = of_node(yielding.yield_depth_m, node, 0.0),
          .share = of_node(yielding.share, node, 0.0),
          .onset_m = of_node(yielding.onset_m, node, 0.0),
          .scale_m = of_node(yielding.scale_m, node, 1.0),
          .largest = of_node(yielding.largest, node, 0.0)};
}

double softened_share(const NodeYielding& node, double deepest_m) {
  return 1.0 - share_left(node, deepest_m);
}

OwnedCurve undamaged_curve(const CurveView& first_press, const NodeYielding& node) {
  OwnedCurve curve;
  curve.depth_m = depths_of(first_press, node);
  for (const double d : curve.depth_m) {
    const ResponseSample at = undamaged(first_press, node, d);
    curve.force_n.push_back(at.force_n);
    curve.stiffness_n_per_m.push_back(at.stiffness_n_per_m);
    curve.energy_j.push_back(0.0);
  }
  // CurveView takes the shallowest depth's slope from the stored one, d <= 0 being 0.
  curve.stiffness_n_per_m.front() = first_press.stiffness_n_per_m.front();
  for (std::size_t i = 0; i + 1 < curve.depth_m.size(); ++i) {
    curve.energy_j[i + 1] = curve.energy_j[i] + interval_energy_j(curve.view(), i);
  }
  return curve;
}

double yielded_stiffness_max_n_per_m(const CurveView& first_press,
                                     const NodeYielding& node) {
  constexpr int kSteps = 8;  // to an interval
  double largest = stiffness_max_n_per_m(first_press);
  for (std::size_t i = 0; i + 1 < first_press.depth_m.size(); ++i) {
    const double from = first_press.depth_m[i];
    const double h = (first_press.depth_m[i + 1] - from) / kSteps;
    for (int k = 1; k <= kSteps; ++k) {
      const double d = from + k * h;
      const double left = share_left(node, d);
      const double stretch = d > node.yield_depth_m ? 1.0 / (1.0 - node.share) : 1.0;
      largest = std::max(
          largest, stretch * left * undamaged(first_press, node, d).stiffness_n_per_m);
    }
  }
  return largest;
}

void make_undamaged(ResponseTable& table) {
  const Yielding& yielding = table.viscoelasticity.yielding;
  if (yielding.largest.empty()) {
    return;
  }
  std::vector<std::int64_t> begin{0};
  OwnedCurve all;
  const auto append = [](std::vector<double>& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  const auto append_curve = [&](const CurveView& curve) {
    append(all.depth_m, curve.depth_m);
    append(all.force_n, curve.force_n);
    append(all.stiffness_n_per_m, curve.stiffness_n_per_m);
    append(all.energy_j, curve.energy_j);
  };
  for (std::int64_t i = 0; i < table.nodes(); ++i) {
    const NodeYielding node = yielding_of(yielding, i);
    const CurveView curve = table.curve(i);
    if (node.largest > 0.0 && !curve.depth_m.empty()) {
      append_curve(undamaged_curve(curve, node).view());
    } else {
      append_curve(curve);
    }
    begin.push_back(std::ssize(all.depth_m));
  }
  table.sample_begin = std::move(begin);
  table.depth_m = std::move(all.depth_m);
  table.force_n = std::move(all.force_n);
  table.stiffness_n_per_m = std::move(all.stiffness_n_per_m);
  table.energy_j = std::move(all.energy_j);
  table.force_errors_n.clear();  // rows of the samples there were
  table.direction_begin.clear();
  table.sample_direction.resize(0, 3);
}

std::string describe(const Yielding& yielding) {
  std::string text;
  if (!yielding.share.empty()) {
    text = fmt::format("dents stay past {} mm, {} % of it",
                       range_text(yielding.yield_depth_m, 1e3),
                       range_text(yielding.share, 100.0));
  }
  if (!yielding.largest.empty()) {
    text += fmt::format("{}softens past {} mm by up to {} %, over {} mm",
                        text.empty() ? "" : "; ", range_text(yielding.onset_m, 1e3),
                        range_text(yielding.largest, 100.0),
                        range_text(yielding.scale_m, 1e3));
  }
  return text;
}

}  // namespace palpate
