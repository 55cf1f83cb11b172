#include "formats/database/database_diff.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/quantile.h"
#include "formats/mesh/angle_between.h"

namespace palpate {
namespace {

// Gauss-Legendre on [0, 1]: exact for the squared difference of two cubics.
constexpr std::array<double, 4> kGaussPlace{0.06943184420297371, 0.33000947820757187,
                                            0.6699905217924281, 0.9305681557970263};
constexpr std::array<double, 4> kGaussWeight{0.17392742256872692, 0.32607257743127305,
                                             0.32607257743127305, 0.17392742256872692};

// Normal penetrations of the samples of both curves up to one, in order, each once.
std::vector<double> common_samples(const PlacedCurve& a, const PlacedCurve& b,
                                   double end_m) {
  std::vector<double> all;
  for (const PlacedCurve* placed : {&a, &b}) {
    for (const double depth_m : placed->curve.depth_m) {
      all.push_back(placed->touch_offset_m + depth_m / placed->along);
    }
  }
  all.push_back(end_m);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  all.erase(std::upper_bound(all.begin(), all.end(), end_m), all.end());
  return all;
}

double ratio(double part, double whole) {
  return part == 0.0 ? 0.0 : part / whole;
}

NodeDifference node_difference(const ResponseTable& a, const ResponseTable& b,
                               std::int64_t node, const Eigen::Vector3d& outward) {
  NodeDifference result;
  result.node = node;
  const PlacedCurve first = placed_curve(a, node, outward);
  const PlacedCurve second = placed_curve(b, node, outward);
  result.curve = difference(first, second);
  result.largest_relative = force_difference(first, second);
  result.relative_rms = ratio(result.curve.rms_n, result.curve.force_rms_n);
  const Eigen::Vector3d u = a.direction.row(node).transpose();
  const Eigen::Vector3d v = b.direction.row(node).transpose();
  result.direction_rad = angle_between(u, v);
  return result;
}

// Longest time that a table's relaxation says something of.
double relaxing_s(const ResponseTable& table) {
  return table.viscoelasticity.empty() ? table.relaxation.seconds
                                       : 5.0 * table.viscoelasticity.tau_s.back();
}

// What stays of a node's force that is held for a time.
double share_that_stays(const ResponseTable& table, std::int64_t node, double time_s) {
  if (!table.viscoelasticity.empty()) {
    return relaxed_share(table.viscoelasticity, node, time_s);
  }
  const ResponseRelaxation& relaxation = table.relaxation;
  return relaxation.empty()
             ? 1.0
             : relaxed_share(relaxation.terms,
                             relaxation.row_of(static_cast<std::size_t>(node)), time_s);
}

// Of it the largest difference at 64 times along the longer of both, denser early.
double relaxation_difference(const ResponseTable& a, const ResponseTable& b,
                             std::int64_t node) {
  constexpr int kTimesCompared = 64;
  double largest = 0.0;
  for (int k = 1; k <= kTimesCompared; ++k) {
    const double part = static_cast<double>(k) / kTimesCompared;
    const double time_s = std::max(relaxing_s(a), relaxing_s(b)) * part * part * part;
    largest = std::max(largest, std::abs(share_that_stays(a, node, time_s) -
                                         share_that_stays(b, node, time_s)));
  }
  return largest;
}

bool same_yielding(const Yielding& a, const Yielding& b) {
  return a.yield_depth_m == b.yield_depth_m && a.share == b.share &&
         a.onset_m == b.onset_m && a.scale_m == b.scale_m && a.largest == b.largest;
}

bool same_memory(const Viscoelasticity& a, const Viscoelasticity& b) {
  return a.instantaneous == b.instantaneous && a.bundle_depth_m == b.bundle_depth_m &&
         a.sites.node == b.sites.node && a.sites.site.rows() == b.sites.site.rows() &&
         a.sites.site == b.sites.site && a.sites.weight == b.sites.weight &&
         same_yielding(a.yielding, b.yielding);
}

StatedErrors stated_errors(const ResponseTable& a,
                           const std::vector<NodeDifference>& nodes) {
  StatedErrors stated;
  if (nodes.empty()) {
    return stated;
  }
  std::vector<double> found;
  std::vector<double> over;
  for (const NodeDifference& node : nodes) {
    const double error = a.error_relative[static_cast<std::size_t>(node.node)];
    stated.covered += node.largest_relative <= error ? 1.0 : 0.0;
    found.push_back(node.largest_relative);
    if (node.largest_relative > 0.0) {
      over.push_back(error / node.largest_relative);
    }
  }
  stated.covered /= static_cast<double>(nodes.size());
  std::sort(found.begin(), found.end());
  std::sort(over.begin(), over.end());
  stated.stated_over_found = quantile(over, 0.5);
  stated.found_median = quantile(found, 0.5);
  stated.found_p95 = quantile(found, 0.95);
  return stated;
}

ToolDifference tool_difference(const ResponseTable& a, const ResponseTable& b,
                               const Points& normal, std::size_t worst) {
  ToolDifference result;
  result.tool = a.tool.name;
  result.same_memory = same_memory(a.viscoelasticity, b.viscoelasticity);
  result.same_puncture = same(a.puncture, b.puncture);
  result.largest_compliance = relative_difference(a.compliance, b.compliance);
  result.largest_contact = relative_difference(a.contact, b.contact);
  double squares = 0.0;
  std::vector<NodeDifference> nodes;
  for (std::int64_t i = 0; i < a.nodes(); ++i) {
    const bool in_a = !a.curve(i).depth_m.empty();
    const bool in_b = !b.curve(i).depth_m.empty();
    result.only_first += in_a && !in_b;
    result.only_second += in_b && !in_a;
    if (!in_a || !in_b) {
      continue;
    }
    ++result.compared;
    const NodeDifference& node =
        nodes.emplace_back(node_difference(a, b, i, normal.row(i).transpose()));
    // rms over all nodes: each counts alike, whatever its depth.
    squares += node.curve.rms_n * node.curve.rms_n;
    result.largest_n = std::max(result.largest_n, node.curve.largest_n);
    result.largest_relative_rms =
        std::max(result.largest_relative_rms, node.relative_rms);
    if (relaxing_s(a) > 0.0 || relaxing_s(b) > 0.0) {
      result.largest_relaxation =
          std::max(result.largest_relaxation, relaxation_difference(a, b, i));
    }
    result.largest_direction_rad =
        std::max(result.largest_direction_rad, node.direction_rad);
    result.largest_depth_m =
        std::max(result.largest_depth_m,
                 std::abs(a.curve(i).depth_max_m() - b.curve(i).depth_max_m()));
  }
  if (result.compared > 0) {
    result.rms_n = std::sqrt(squares / static_cast<double>(result.compared));
  }
  result.stated = stated_errors(a, nodes);
  const auto listed = static_cast<std::ptrdiff_t>(std::min(worst, nodes.size()));
  std::partial_sort(nodes.begin(), nodes.begin() + listed, nodes.end(),
                    [](const NodeDifference& x, const NodeDifference& y) {
                      return x.relative_rms != y.relative_rms
                                 ? x.relative_rms > y.relative_rms
                                 : x.node < y.node;
                    });
  result.worst.assign(nodes.begin(), nodes.begin() + listed);
  return result;
}

}  // namespace

CurveDifference difference(const PlacedCurve& a, const PlacedCurve& b) {
  CurveDifference result;
  if (a.curve.depth_m.empty() || b.curve.depth_m.empty()) {
    return result;
  }
  const double end_m = std::min(a.end_m(), b.end_m());
  const std::vector<double> at_m = common_samples(a, b, end_m);
  double squares = 0.0;
  double force_squares = 0.0;
  for (std::size_t i = 0; i + 1 < at_m.size(); ++i) {
    const double h = at_m[i + 1] - at_m[i];
    for (std::size_t q = 0; q < kGaussPlace.size(); ++q) {
      const double at = at_m[i] + h * kGaussPlace[q];
      const Eigen::Vector3d force_n = a.force_n(at);
      const double off_n = (b.force_n(at) - force_n).norm();
      // Gauss points of an interval: integrals of |F_b - F_a|^2 and |F_a|^2 over the
      // depth. rms is the root of the integral over the common depth.
      squares += h * kGaussWeight[q] * off_n * off_n;
      force_squares += h * kGaussWeight[q] * force_n.squaredNorm();
      result.largest_n = std::max(result.largest_n, off_n);
    }
  }
  if (at_m.size() > 1) {
    result.depth_m = end_m - at_m.front();
    result.rms_n = std::sqrt(squares / result.depth_m);
    result.force_rms_n = std::sqrt(force_squares / result.depth_m);
    result.largest_n =
        std::max(result.largest_n, (b.force_n(end_m) - a.force_n(end_m)).norm());
  }
  return result;
}

bool ToolDifference::agrees(double tolerance_relative) const {
  return only_first == 0 && only_second == 0 && largest_depth_m == 0.0 &&
         largest_relative_rms <= tolerance_relative && same_memory && same_puncture &&
         largest_relaxation <= tolerance_relative &&
         largest_compliance <= tolerance_relative &&
         largest_contact <= tolerance_relative &&
         largest_direction_rad <= tolerance_relative;
}

void require_same_body(const ResponseDatabase& a, const ResponseDatabase& b) {
  const SurfaceMesh& first = a.body;
  const SurfaceMesh& second = b.body;
  if (first.position_m.rows() != second.position_m.rows() ||
      first.triangle.rows() != second.triangle.rows()) {
    throw InputError(
        fmt::format("the bodies differ: {} nodes and {} triangles, and {} and {}",
                    first.position_m.rows(), first.triangle.rows(),
                    second.position_m.rows(), second.triangle.rows()));
  }
  for (Eigen::Index i = 0; i < first.position_m.rows(); ++i) {
    if (first.position_m.row(i) != second.position_m.row(i)) {
      throw InputError(fmt::format(
          "the bodies differ: node {} is at ({}, {}, {}) m and at ({}, {}, {}) m", i,
          first.position_m(i, 0), first.position_m(i, 1), first.position_m(i, 2),
          second.position_m(i, 0), second.position_m(i, 1), second.position_m(i, 2)));
    }
  }
  if (first.triangle != second.triangle) {
    throw InputError("the bodies differ: their triangles join different nodes");
  }
}

std::vector<ToolDifference> difference(const ResponseDatabase& a,
                                       const ResponseDatabase& b, std::size_t worst) {
  require_same_body(a, b);
  std::vector<ToolDifference> result;
  for (const ResponseTable& table : a.tools) {
    const auto other = std::find_if(b.tools.begin(), b.tools.end(), [&](const auto& t) {
      return t.tool.name == table.tool.name;
    });
    if (other != b.tools.end()) {
      result.push_back(tool_difference(table, *other, a.normal, worst));
    }
  }
  if (result.empty()) {
    throw InputError(fmt::format(
        "no tool in common: the first file's first is {:?}, the second's {:?}",
        a.tools.front().tool.name, b.tools.front().tool.name));
  }
  return result;
}

}  // namespace palpate
