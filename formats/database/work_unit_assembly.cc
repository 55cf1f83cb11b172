// Putting units together to a database.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/base/error.h"
#include "formats/base/quantile.h"
#include "formats/database/error_calibration.h"
#include "formats/database/table_memory.h"
#include "formats/database/work_unit.h"
#include "formats/response/force_difference.h"
#include "formats/response/response_curve.h"

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
    assembly.hard_path += (response.flags & kHardPath) != 0 ? 1 : 0;
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

}  // namespace

double response_difference(const NodeResponse& response, const NodeResponse& reference,
                           const Eigen::Vector3d& outward) {
  if (response.depth_m.size() < 2 || reference.depth_m.size() < 2) {
    return response.depth_m.size() == reference.depth_m.size() ? 0.0 : 1.0;
  }
  const ResponseCurve curve(response.depth_m, response.force_n);
  const ResponseCurve better(reference.depth_m, reference.force_n);
  const auto placed = [&](const ResponseCurve& of, const NodeResponse& node) {
    return PlacedCurve{of.view(),
                       node.touch_offset_m,
                       std::abs(outward.dot(node.direction)),
                       node.direction,
                       outward,
                       node.tilt,
                       node.sample_direction.empty()
                           ? std::span<const double>{}
                           : std::span(node.sample_direction.front().data(),
                                       3 * node.sample_direction.size())};
  };
  return force_difference(placed(curve, response), placed(better, reference));
}

namespace {

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
  std::vector<double> verified;        // (n) NaN where not

  explicit ToolAnswers(std::size_t nodes)
      : response(nodes),
        failure(nodes),
        verified(nodes, std::numeric_limits<double>::quiet_NaN()) {}
};

void take(const JobDescription& plan, const WorkUnitOutcome& unit,
          std::vector<ToolAnswers>& answers) {
  for (const WorkUnitNode& node : unit.node) {
    ToolAnswers& tool = answers.at(static_cast<std::size_t>(node.tool));
    const auto v = static_cast<std::size_t>(node.vertex);
    if (!unit.is_check) {
      tool.response.at(v) = node.response;
      tool.failure.at(v) = node.failure;
      const bool truncated = !node.failure.empty() && !node.response.depth_m.empty();
      tool.response[v].flags = static_cast<std::uint8_t>(
          node.response.flags | (truncated ? kTruncatedPath : 0));
    } else if (node.response.depth_m.size() > 1) {
      tool.verified.at(v) = response_difference(
          tool.response.at(v), node.response, plan.normal.row(node.vertex).transpose());
    }
  }
}

// Factors on estimates: of nodes whose path was easy to follow, and of the others,
// which are few and off by more.
struct ErrorFactors {
  double easy = 0.0;
  double hard = 0.0;  // 0: there is no such node
};

// Estimates become stated errors, and flags where those are above the budget.
double calibrate(const JobDescription& plan, ToolAnswers& tool, bool hard) {
  std::vector<double> estimate;
  std::vector<double> error;
  std::vector<NodeResponse*> nodes;
  for (std::size_t v = 0; v < tool.response.size(); ++v) {
    NodeResponse& response = tool.response[v];
    if (response.origin != ResponseOrigin::kNone &&
        ((response.flags & kHardPath) != 0) == hard) {
      nodes.push_back(&response);
      if (!std::isnan(tool.verified[v]) && response.error_relative > 0.0) {
        estimate.push_back(response.error_relative);
        error.push_back(kErrorPerCheck * tool.verified[v]);
      }
    }
  }
  if (nodes.empty()) {
    return 0.0;
  }
  const double factor = calibrate_errors(estimate, error);
  for (NodeResponse* response : nodes) {
    response->error_relative *= factor;
    if (response->error_relative > plan.force_relative) {
      response->flags = static_cast<std::uint8_t>(response->flags | kErrorOverBudget);
    }
  }
  return factor;
}

AccuracyRecord accuracy_record(double budget, const ErrorFactors& factor,
                               std::vector<double> verified) {
  std::erase_if(verified, [](double error) {
    return std::isnan(error);
  });
  if (verified.empty()) {
    return {.budget_relative = budget,
            .error_factor = factor.easy,
            .hard_error_factor = factor.hard,
            .quantile_level = {},
            .error_relative = {}};
  }
  std::sort(verified.begin(), verified.end());
  AccuracyRecord record{.budget_relative = budget,
                        .error_factor = factor.easy,
                        .hard_error_factor = factor.hard,
                        .verified = static_cast<std::int64_t>(verified.size()),
                        .quantile_level = {0.0, 0.25, 0.5, 0.75, 0.95, 1.0},
                        .error_relative = {}};
  for (const double level : record.quantile_level) {
    record.error_relative.push_back(quantile(verified, level));
  }
  return record;
}

ResponseTable table_of(const JobDescription& plan, std::size_t t,
                       const ToolAnswers& tool, const ErrorFactors& error_factor) {
  ResponseTable table = make_table(plan.tool[t], tool.response);
  table.accuracy = accuracy_record(plan.force_relative, error_factor, tool.verified);
  if (table.accuracy.verified > 0) {
    table.verified_error_relative = tool.verified;
  }
  const auto failed = [](const std::string& reason) {
    return !reason.empty();
  };
  if (std::any_of(tool.failure.begin(), tool.failure.end(), failed)) {
    std::map<std::string, std::int32_t> row;
    for (const std::string& reason : tool.failure) {
      std::int32_t found = -1;
      if (!reason.empty()) {
        found = row.try_emplace(reason, static_cast<std::int32_t>(row.size()))
                    .first->second;
        if (static_cast<std::size_t>(found) == table.failure_reason.size()) {
          table.failure_reason.push_back(reason);
        }
      }
      table.failure.push_back(found);
    }
  }
  return table;
}

}  // namespace

Assembly assemble(const JobDescription& plan, std::span<const WorkUnitOutcome> units) {
  check_complete(plan, units);
  Assembly assembly;
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
    take(plan, unit, answers);
    for (const WorkUnitNode& node : unit.node) {
      if (!unit.is_check) {
        count(plan, node, assembly);
      }
    }
  }
  for (std::size_t t = 0; t < plan.tool.size(); ++t) {
    std::copy_if(answers[t].verified.begin(), answers[t].verified.end(),
                 std::back_inserter(assembly.checked), [](double error) {
                   return !std::isnan(error);
                 });
    const ErrorFactors factor{calibrate(plan, answers[t], false),
                              calibrate(plan, answers[t], true)};
    for (const NodeResponse& response : answers[t].response) {
      if (response.origin != ResponseOrigin::kNone) {
        assembly.error.push_back(response.error_relative);
        assembly.over_budget += (response.flags & kErrorOverBudget) != 0 ? 1 : 0;
      }
    }
    assembly.error_factor = std::max(assembly.error_factor, factor.easy);
    assembly.hard_error_factor = std::max(assembly.hard_error_factor, factor.hard);
    assembly.database.tools.push_back(table_of(plan, t, answers[t], factor));
    Viscoelasticity relaxation = plan.relaxation;
    relaxation.yielding = plan.yielding.empty() ? Yielding{} : plan.yielding[t];
    give_memory(plan.body, plan.normal, relaxation, plan.bundles,
                assembly.database.tools.back());
  }
  std::sort(assembly.error.begin(), assembly.error.end());
  std::sort(assembly.checked.begin(), assembly.checked.end());
  assembly.outside_reach = static_cast<std::int64_t>(plan.tool.size()) *
                           (static_cast<std::int64_t>(nodes) - plan.reachable);
  assembly.database.body = plan.body;
  assembly.database.normal = plan.normal;
  assembly.database.provenance = plan.provenance;
  assembly.database.provenance.left_out = left_out(plan, assembly);
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
