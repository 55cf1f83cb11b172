// Putting units together to a database.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/base/error.h"
#include "formats/database/error_calibration.h"
#include "formats/database/place_check.h"
#include "formats/database/stated_errors.h"
#include "formats/database/table_memory.h"
#include "formats/database/work_unit.h"

namespace palpate {
namespace {

void check_complete(const JobDescription& plan,
                    std::span<const WorkUnitOutcome> units) {
  std::vector<int> seen(static_cast<std::size_t>(plan.units), 0);
  for (const WorkUnitOutcome& unit : units) {
    if (unit.index < 0 || unit.index >= plan.units) {
      throw InputError(
          fmt::format("unit {} is none of the plan's {}", unit.index, plan.units));
    }
    if (++seen[static_cast<std::size_t>(unit.index)] > 1) {
      throw InputError(fmt::format("unit {} comes twice", unit.index));
    }
  }
  for (const WorkUnitOutcome& unit : units) {
    for (const WorkUnitNode& node : unit.node) {
      if (node.tool < 0 || std::cmp_greater_equal(node.tool, plan.tool.size()) ||
          node.vertex < 0 || node.vertex >= plan.body.position_m.rows()) {
        throw InputError(fmt::format(
            "unit {} answers tool {} at vertex {}: the body has {} vertices, the scene "
            "{} tools",
            unit.index, node.tool, node.vertex, plan.body.position_m.rows(),
            plan.tool.size()));
      }
    }
    const SurfacePoint& place = unit.place;
    if (std::cmp_greater_equal(place.triangle, plan.body.triangle.rows()) ||
        (place.triangle >= 0 &&
         !(place.area_coordinate.minCoeff() >= 0.0 &&
           std::abs(place.area_coordinate.sum() - 1.0) < 1e-6))) {
      throw InputError(
          fmt::format("unit {} checks triangle {} at area coordinates ({}, {}, {}): "
                      "the body has {} "
                      "triangles, coordinates must be at least 0 and sum to 1",
                      unit.index, place.triangle, place.area_coordinate.x(),
                      place.area_coordinate.y(), place.area_coordinate.z(),
                      plan.body.triangle.rows()));
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

void count(const JobDescription& plan, const WorkUnitNode& node, Assembly& assembly) {
  const NodeResponse& response = node.response;
  const bool has_curve = response.origin != ResponseOrigin::kNone;
  if (!node.failure.empty()) {
    assembly.failures.push_back(
        fmt::format("vertex {}, tool {}: {}", node.vertex,
                    plan.tool[static_cast<std::size_t>(node.tool)].name, node.failure));
    ++(has_curve ? assembly.truncated : assembly.failed);
  } else if ((response.flags & kTruncatedPath) != 0) {
    ++assembly.ended_at_support;
  }
  if (has_curve) {
    ++(response.origin == ResponseOrigin::kInterpolated ? assembly.interpolated
                                                        : assembly.solved);
    assembly.near_singular += (response.flags & kNearSingular) != 0 ? 1 : 0;
    assembly.reaching_elsewhere += node.reaches_elsewhere ? 1 : 0;
  } else if (node.failure.empty()) {
    ++assembly.untouched;
  }
}

std::string left_out(const JobDescription& plan, const Assembly& assembly) {
  return fmt::format(
      "{} nodes held or outside reach, {} failed, {} untouched; depths beyond {} m and "
      "forces beyond {} N{}{}{}",
      assembly.outside_reach, assembly.failed, assembly.untouched, plan.depth_max_m,
      plan.force_max_n,
      assembly.tilts_limited == 0
          ? ""
          : fmt::format("; tilts of {} of {} responses beyond their limits",
                        assembly.tilts_limited, assembly.error.size()),
      plan.left_out.empty() ? "" : "; ", plan.left_out);
}

std::vector<const WorkUnitOutcome*> in_order(std::span<const WorkUnitOutcome> units) {
  std::vector<const WorkUnitOutcome*> ordered;
  for (const WorkUnitOutcome& unit : units) {
    ordered.push_back(&unit);
  }
  std::sort(ordered.begin(), ordered.end(), [](const auto* a, const auto* b) {
    return a->index < b->index;
  });
  return ordered;
}

// What one tool's nodes answered.
struct ToolAnswers {
  std::vector<NodeResponse> response;  // (n)
  std::vector<std::string> failure;    // (n)
  std::vector<std::string> history;    // (n)
  std::vector<PlaceCheck> check;

  explicit ToolAnswers(std::size_t nodes)
      : response(nodes), failure(nodes), history(nodes) {}
};

void take(const WorkUnitOutcome& unit, std::vector<ToolAnswers>& answers) {
  for (const WorkUnitNode& node : unit.node) {
    ToolAnswers& tool = answers.at(static_cast<std::size_t>(node.tool));
    const auto v = static_cast<std::size_t>(node.vertex);
    if (!unit.is_check) {
      tool.response.at(v) = node.response;
      tool.failure.at(v) = node.failure;
      tool.history.at(v) = node.history;
      const bool truncated = !node.failure.empty() && !node.response.depth_m.empty();
      tool.response[v].flags = static_cast<std::uint8_t>(
          node.response.flags | (truncated ? kTruncatedPath : 0));
    } else {
      tool.check.push_back({node.vertex, unit.place, node.response});
      if (!node.failure.empty()) {
        // The hard ones fail: left out, they would make the others' errors too small.
        tool.check.back().found = std::numeric_limits<double>::infinity();
      }
    }
  }
}

// Each line once, and by node which it is, -1: none; nothing where no node has one.
void number_lines(std::span<const std::string> of_node,
                  std::vector<std::int32_t>& row_of_node,
                  std::vector<std::string>& lines) {
  std::map<std::string, std::int32_t> row;
  for (const std::string& line : of_node) {
    std::int32_t found = -1;
    if (!line.empty()) {
      found =
          row.try_emplace(line, static_cast<std::int32_t>(row.size())).first->second;
      if (static_cast<std::size_t>(found) == lines.size()) {
        lines.push_back(line);
      }
    }
    row_of_node.push_back(found);
  }
  if (lines.empty()) {
    row_of_node.clear();
  }
}

// What checks and failures say of a tool's table, whose errors are estimates so far.
void complete(double budget, const ToolAnswers& tool, const ErrorFactors& error_factor,
              ResponseTable& table) {
  for (std::size_t v = 0; v < tool.response.size(); ++v) {
    table.error_relative[v] = tool.response[v].error_relative;
    table.flags[v] = static_cast<std::uint8_t>(table.flags[v] | tool.response[v].flags);
  }
  table.accuracy = accuracy_record(budget, error_factor, tool.check);
  if (table.accuracy.verified > 0) {
    table.verified_error_relative.assign(tool.response.size(),
                                         std::numeric_limits<double>::quiet_NaN());
    for (const PlaceCheck& check : tool.check) {
      if (std::isfinite(check.found)) {
        double& largest =
            table.verified_error_relative[static_cast<std::size_t>(check.vertex)];
        largest = std::fmax(largest, check.found);  // of NaN and a number the number
      }
    }
  }
  number_lines(tool.failure, table.failure, table.failure_reason);
  number_lines(tool.history, table.history, table.history_text);
}

void count_checks(const std::vector<PlaceCheck>& checks, Assembly& assembly) {
  for (const PlaceCheck& check : checks) {
    if (std::isfinite(check.found)) {
      assembly.checked.push_back(check.found);
    }
    assembly.checked_in_vain += std::isinf(check.found) ? 1 : 0;
  }
}

// What the scene states of a tool's responses: how they relax, yield and are punctured.
void take_from_plan(const JobDescription& plan, std::size_t tool,
                    ResponseTable& table) {
  if (!plan.puncture.empty()) {
    table.puncture = plan.puncture[tool];
  }
  Viscoelasticity relaxation = plan.relaxation;
  relaxation.yielding = plan.yielding.empty() ? Yielding{} : plan.yielding[tool];
  give_memory(plan.body, plan.normal, relaxation, plan.bundles, table);
}

}  // namespace

Assembly assemble(const JobDescription& plan, std::span<const WorkUnitOutcome> units,
                  const StoredForces& stored) {
  check_complete(plan, units);
  Assembly assembly;
  ResponseDatabase& database = assembly.database;
  database.body = plan.body;
  database.normal = plan.normal;
  database.provenance = plan.provenance;
  const auto nodes = static_cast<std::size_t>(plan.body.position_m.rows());
  std::vector<ToolAnswers> answers(plan.tool.size(), ToolAnswers(nodes));
  const std::vector<double> longest_edge_m = longest_edges_m(plan.body);
  // Checks come last in a plan, and compare with what was taken before.
  for (const WorkUnitOutcome* given : in_order(units)) {
    WorkUnitOutcome unit = *given;
    std::for_each(unit.node.begin(), unit.node.end(), fail_if_broken);
    for (WorkUnitNode& node : unit.node) {
      // Checks stay what they found.
      assembly.tilts_limited +=
          !unit.is_check &&
          limit_tilt(node.response, plan.normal.row(node.vertex).transpose(),
                     longest_edge_m[static_cast<std::size_t>(node.vertex)]);
    }
    take(unit, answers);
    for (const WorkUnitNode& node : unit.node) {
      if (!unit.is_check) {
        count(plan, node, assembly);
      }
    }
  }
  for (std::size_t t = 0; t < plan.tool.size(); ++t) {
    database.tools.push_back(make_table(plan.tool[t], answers[t].response));
    compare(database, answers[t].response, stored, answers[t].check);
    count_checks(answers[t].check, assembly);
    const ErrorFactors factor = state_errors(plan.body, plan.force_relative,
                                             answers[t].check, answers[t].response);
    for (const NodeResponse& response : answers[t].response) {
      if (response.origin != ResponseOrigin::kNone) {
        assembly.error.push_back(response.error_relative);
        assembly.over_budget += (response.flags & kErrorOverBudget) != 0 ? 1 : 0;
      }
    }
    assembly.error_factor = std::max(assembly.error_factor, factor.easy.factor);
    assembly.hard_error_factor =
        std::max(assembly.hard_error_factor, factor.hard.factor);
    assembly.error_covered = std::min(assembly.error_covered, factor.easy.covered);
    assembly.hard_error_covered =
        std::min(assembly.hard_error_covered, factor.hard.covered);
    complete(plan.force_relative, answers[t], factor, database.tools.back());
    take_from_plan(plan, t, database.tools.back());
  }
  std::sort(assembly.error.begin(), assembly.error.end());
  std::sort(assembly.checked.begin(), assembly.checked.end());
  assembly.outside_reach = static_cast<std::int64_t>(plan.tool.size()) *
                           (static_cast<std::int64_t>(nodes) - plan.reachable);
  database.provenance.left_out = left_out(plan, assembly);
  database.provenance.plan_sha256 = plan.digest;
  return assembly;
}

void require_responses(const JobDescription& plan, const Assembly& assembly) {
  if (assembly.solved == 0) {
    throw NumericalError(fmt::format(
        "none of the {} reachable vertices gave a response: {}", plan.reachable,
        assembly.failures.empty()
            ? fmt::format("the tool touched nothing within depth_max_m = {}",
                          plan.depth_max_m)
            : assembly.failures.front()));
  }
}

}  // namespace palpate
