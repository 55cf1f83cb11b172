// Putting units together to a database.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/error.h"
#include "formats/response_curve.h"
#include "formats/response_shard.h"

namespace palpate {
namespace {

void check_complete(const UnitPlan& plan, std::span<const UnitOutcome> units) {
  std::vector<int> seen(static_cast<std::size_t>(plan.units), 0);
  for (const UnitOutcome& unit : units) {
    if (unit.index < 0 || unit.index >= plan.units) {
      throw InputError(
          fmt::format("unit {} is none of the plan's {}", unit.index, plan.units));
    }
    if (++seen[static_cast<std::size_t>(unit.index)] > 1) {
      throw InputError(fmt::format("unit {} comes twice", unit.index));
    }
  }
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < seen.size() && missing.size() < 8; ++i) {
    if (seen[i] == 0) {
      missing.push_back(i);
    }
  }
  if (!missing.empty()) {
    throw InputError(fmt::format(
        "{} of {} units are missing: {}{}", std::count(seen.begin(), seen.end(), 0),
        plan.units, fmt::join(missing, ", "), missing.size() < 8 ? "" : ", ..."));
  }
}

void count(const UnitPlan& plan, const UnitNode& node, Assembly& assembly) {
  const NodeResponse& response = node.response;
  const bool has_curve = response.origin != ResponseOrigin::kNone;
  if (!node.failure.empty()) {
    assembly.failures.push_back(
        fmt::format("vertex {}, tool {}: {}", node.vertex,
                    plan.tool[static_cast<std::size_t>(node.tool)].name, node.failure));
    ++(has_curve ? assembly.truncated : assembly.failed);
  }
  if (has_curve) {
    ++(response.origin == ResponseOrigin::kInterpolated ? assembly.interpolated
                                                        : assembly.solved);
    assembly.error.push_back(response.error_relative);
    assembly.over_budget += (response.flags & kErrorOverBudget) != 0 ? 1 : 0;
  } else if (node.failure.empty()) {
    ++assembly.untouched;
  }
}

std::string left_out(const UnitPlan& plan, const Assembly& assembly) {
  return fmt::format(
      "{} nodes held or outside reach, {} failed, {} untouched; depths beyond {} m and "
      "forces beyond {} N",
      assembly.outside_reach, assembly.failed, assembly.untouched, plan.depth_max_m,
      plan.force_max_n);
}

}  // namespace

double response_difference(const NodeResponse& response, const NodeResponse& reference,
                           const Eigen::Vector3d& outward) {
  constexpr int kSteps = 16;
  constexpr double kFloor = 0.1;  // of the largest force
  if (response.depth_m.size() < 2 || reference.depth_m.size() < 2) {
    return response.depth_m.size() == reference.depth_m.size() ? 0.0 : 1.0;
  }
  const auto force_at = [&](const NodeResponse& r, double penetration_m) {
    const double depth =
        (penetration_m - r.touch_offset_m) * std::abs(outward.dot(r.direction));
    return ResponseCurve(r.depth_m, r.force_n).at(std::max(0.0, depth)).force_n;
  };
  const auto end_m = [&](const NodeResponse& r) {
    return r.touch_offset_m + r.depth_m.back() / std::abs(outward.dot(r.direction));
  };
  const double touch = std::min(response.touch_offset_m, reference.touch_offset_m);
  const double end = std::min(end_m(response), end_m(reference));
  const double floor_n = kFloor * reference.force_n.back();
  double sum = 0.0;
  for (int k = 1; k <= kSteps; ++k) {
    const double penetration = touch + (end - touch) * k / kSteps;
    const double wanted = force_at(reference, penetration);
    const double difference =
        (force_at(response, penetration) - wanted) / std::max(wanted, floor_n);
    sum += difference * difference;
  }
  return std::sqrt(sum / kSteps);
}

Assembly assemble(const UnitPlan& plan, std::span<const UnitOutcome> units) {
  check_complete(plan, units);
  Assembly assembly;
  const auto nodes = static_cast<std::size_t>(plan.body.position_m.rows());
  std::vector<std::vector<NodeResponse>> responses(plan.tool.size(),
                                                   std::vector<NodeResponse>(nodes));
  std::vector<const UnitOutcome*> ordered;
  for (const UnitOutcome& unit : units) {
    ordered.push_back(&unit);
  }
  std::sort(ordered.begin(), ordered.end(), [](const auto* a, const auto* b) {
    return a->index < b->index;
  });
  for (const UnitOutcome* unit : ordered) {
    for (const UnitNode& node : unit->node) {
      if (!unit->is_check) {
        count(plan, node, assembly);
        responses.at(static_cast<std::size_t>(node.tool))
            .at(static_cast<std::size_t>(node.vertex)) = node.response;
      }
    }
  }
  for (const UnitOutcome* unit : ordered) {
    for (const UnitNode& node : unit->node) {
      const bool usable = unit->is_check && node.response.depth_m.size() > 1;
      if (usable) {
        assembly.checked.push_back(response_difference(
            responses.at(static_cast<std::size_t>(node.tool))
                .at(static_cast<std::size_t>(node.vertex)),
            node.response, plan.normal.row(node.vertex).transpose()));
      }
    }
  }
  std::sort(assembly.error.begin(), assembly.error.end());
  std::sort(assembly.checked.begin(), assembly.checked.end());
  assembly.outside_reach = static_cast<std::int64_t>(plan.tool.size()) *
                           (static_cast<std::int64_t>(nodes) - plan.reachable);
  for (std::size_t t = 0; t < plan.tool.size(); ++t) {
    assembly.database.tools.push_back(make_table(plan.tool[t], responses[t]));
  }
  assembly.database.body = plan.body;
  assembly.database.normal = plan.normal;
  assembly.database.provenance = plan.provenance;
  assembly.database.provenance.left_out = left_out(plan, assembly);
  return assembly;
}

}  // namespace palpate
