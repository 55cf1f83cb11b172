#include "formats/response/pressure_law.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

PressureLaw::Part part_of(const ResponseTable& table, std::int64_t node,
                          const Eigen::Vector3d& outward) {
  return {.curve = table.curve(node),
          .lean = std::abs(outward.dot(table.direction.row(node).transpose()))};
}

}  // namespace

PressureLaw::PressureLaw(double radius_m, std::vector<Part> parts)
    : radius_m_(radius_m),
      depth_max_m_(std::numeric_limits<double>::infinity()),
      part_(std::move(parts)) {
  for (const Part& part : part_) {
    depth_max_m_ =
        std::min(depth_max_m_, part.later_m + part.curve.depth_max_m() / part.lean);
  }
}

double PressureLaw::pressure_pa(double depth_m) const noexcept {
  double slope_n_per_m = 0.0;
  for (const Part& part : part_) {
    slope_n_per_m +=
        part.weight * part.lean * part.lean *
        part.curve.at(part.lean * (depth_m - part.later_m)).stiffness_n_per_m;
  }
  return slope_n_per_m / (kTurn * radius_m_);
}

double PressureLaw::force_n(double depth_m, double radius_m) const noexcept {
  double force_n = 0.0;
  for (const Part& part : part_) {
    force_n += part.weight * part.lean *
               part.curve.at(part.lean * (depth_m - part.later_m)).force_n;
  }
  return force_n * (radius_m / radius_m_);
}

double PressureLaw::energy_j(double depth_m) const noexcept {
  double energy_j = 0.0;
  for (const Part& part : part_) {
    energy_j +=
        part.weight * part.curve.at(part.lean * (depth_m - part.later_m)).energy_j;
  }
  return energy_j;
}

std::vector<double> PressureLaw::knots_m() const {
  std::vector<double> knots{0.0, depth_max_m_};
  for (const Part& part : part_) {
    for (const double depth_m : part.curve.depth_m) {
      const double at = part.later_m + depth_m / part.lean;
      if (at > 0.0 && at < depth_max_m_) {
        knots.push_back(at);
      }
    }
  }
  std::sort(knots.begin(), knots.end());
  return knots;
}

LinearPressure linear_pressure(const PressureLaw& law, double depth_max_m) {
  const double end = depth_max_m;
  if (!(end > 0.0 && std::isfinite(end))) {
    throw InputError(
        fmt::format("largest depth is {} m, must be positive and finite", end));
  }
  // Least squares: slope = int p y / int y^2. By parts int p y = (y F - int F) / (2 pi
  // R).
  const double force_n = law.force_n(end, law.radius_m());
  const double moment = (end * force_n - law.energy_j(end)) / (kTurn * law.radius_m());
  const double slope = moment / (end * end * end / 3.0);
  // int p^2: p is of second degree between knots, p^2 of fourth; three points of Gauss
  // integrate the fifth exactly.
  const std::array<std::pair<double, double>, 3> gauss{
      {{-std::sqrt(0.6), 5.0 / 18.0}, {0.0, 8.0 / 18.0}, {std::sqrt(0.6), 5.0 / 18.0}}};
  std::vector<double> knots = law.knots_m();
  knots.push_back(end);
  std::sort(knots.begin(), knots.end());
  double squares = 0.0;
  for (std::size_t i = 0; i + 1 < knots.size() && knots[i + 1] <= end; ++i) {
    const double width = knots[i + 1] - knots[i];
    for (const auto& [at, weight] : gauss) {
      const double p = law.pressure_pa(knots[i] + 0.5 * width * (1.0 + at));
      squares += weight * width * p * p;
    }
  }
  // int (p - k y)^2 = int p^2 - k int p y, at the best k.
  const double left = std::max(0.0, squares - slope * moment);
  const double linear_n = kTurn * law.radius_m() * 0.5 * slope * end * end;
  return {.slope_pa_per_m = slope,
          .misfit_relative = squares > 0.0 ? std::sqrt(left / squares) : 0.0,
          .force_error_relative = force_n > 0.0 ? linear_n / force_n - 1.0 : 0.0};
}

void check_gives_pressure(const ToolShape& tool) {
  if (tool.kind != "sphere" || !tool.contact.empty()) {
    throw InputError(fmt::format(
        "tool {:?} is a {}: a pressure law follows from the press of one sphere",
        tool.name, tool.contact.empty() ? tool.kind : "set of spheres"));
  }
}

PressureLaw pressure_law(const ResponseTable& table, std::int64_t node,
                         const Eigen::Vector3d& outward) {
  check_gives_pressure(table.tool);
  if (node < 0 || node >= table.nodes()) {
    throw InputError(
        fmt::format("node is {}, must lie in [0, {}]", node, table.nodes() - 1));
  }
  if (table.curve(node).depth_m.empty()) {
    throw InputError(
        fmt::format("node {} has no response to tool {:?}", node, table.tool.name));
  }
  return {table.tool.radius_m, {part_of(table, node, outward)}};
}

PressureLaw pressure_law(const ResponseTable& table,
                         const std::array<std::int64_t, 3>& node,
                         const Eigen::Vector3d& share, const Eigen::Matrix3d& outward) {
  check_gives_pressure(table.tool);
  std::vector<PressureLaw::Part> parts;
  double first_m = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < 3; ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    if (share(column) > 0.0 && !table.curve(node[j]).depth_m.empty()) {
      PressureLaw::Part part = part_of(table, node[j], outward.col(column));
      part.weight = share(column);
      part.later_m = table.touch_offset_m[static_cast<std::size_t>(node[j])];
      first_m = std::min(first_m, part.later_m);
      parts.push_back(part);
    }
  }
  if (parts.empty()) {
    throw InputError(fmt::format("nodes {}, {} and {} have no response to tool {:?}",
                                 node[0], node[1], node[2], table.tool.name));
  }
  for (PressureLaw::Part& part : parts) {
    part.later_m -= first_m;
  }
  return {table.tool.radius_m, std::move(parts)};
}

}  // namespace palpate
