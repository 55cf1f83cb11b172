#include "formats/database/database_summary.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "formats/database/error_calibration.h"
#include "formats/response/memory_sites.h"
#include "formats/response/yielding.h"

namespace palpate {
namespace {

double largest_of(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

}  // namespace

ToolSummary summarise(const ResponseTable& table) {
  const auto of_origin = [&](ResponseOrigin origin) {
    return std::count(table.origin.begin(), table.origin.end(),
                      static_cast<std::uint8_t>(origin));
  };
  const auto flagged = [&](ResponseFlag flag) {
    return std::count_if(table.flags.begin(), table.flags.end(),
                         [&](std::uint8_t bits) {
                           return (bits & flag) != 0;
                         });
  };
  ToolSummary summary;
  summary.tool = table.tool;
  summary.responses = table.nodes() - of_origin(ResponseOrigin::kNone);
  summary.simulated = of_origin(ResponseOrigin::kSimulated);
  summary.interpolated = of_origin(ResponseOrigin::kInterpolated);
  summary.measured = of_origin(ResponseOrigin::kMeasured);
  summary.falling = flagged(kFallingCurve);
  summary.force_capped = flagged(kForceCapped);
  summary.coarse_contact = flagged(kCoarseContact);
  summary.error_over_budget = flagged(kErrorOverBudget);
  summary.failed = flagged(kFailed);
  summary.extrapolated = flagged(kExtrapolated);
  summary.truncated_path = flagged(kTruncatedPath);
  summary.near_singular = flagged(kNearSingular);
  summary.depth_max_m = table.depth_max_m();
  summary.force_max_n = largest_of(table.force_n);
  summary.stiffness_max_n_per_m = largest_of(table.stiffness_max_n_per_m);
  summary.error_relative_max = largest_of(table.error_relative);
  summary.direction_spread_max_rad = largest_of(table.direction_spread_rad);
  summary.relaxation = table.relaxation;
  summary.yielding = describe(table.viscoelasticity.yielding);
  if (table.viscoelasticity.remembers()) {
    summary.viscoelasticity = table.viscoelasticity;
    if (!table.viscoelasticity.empty()) {
      summary.shares = share_extent(table.viscoelasticity);
    }
    summary.memory_sites = std::ssize(table.viscoelasticity.sites.node);
  }
  summary.compliance = table.compliance;
  summary.compliance.value.resize(0, 0);
  summary.compliance.mode.resize(0, table.compliance.mode.cols());
  summary.puncture = table.puncture;
  summary.contact = describe(table.contact);
  summary.accuracy = table.accuracy;
  return summary;
}

ToolSummary summarise(const ToolIndex& tool) {
  const auto of_origin = [&](ResponseOrigin origin) {
    return tool.origin_count[static_cast<std::size_t>(origin)];
  };
  const auto flagged = [&](ResponseFlag flag) {
    // flag_count has a number by bit. Older files lack the last.
    const auto bit =
        static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(flag)));
    return bit < tool.flag_count.size() ? tool.flag_count[bit] : 0;
  };
  ToolSummary summary;
  summary.tool = tool.tool;
  summary.simulated = of_origin(ResponseOrigin::kSimulated);
  summary.interpolated = of_origin(ResponseOrigin::kInterpolated);
  summary.measured = of_origin(ResponseOrigin::kMeasured);
  summary.responses = summary.simulated + summary.interpolated + summary.measured;
  summary.falling = flagged(kFallingCurve);
  summary.force_capped = flagged(kForceCapped);
  summary.coarse_contact = flagged(kCoarseContact);
  summary.error_over_budget = flagged(kErrorOverBudget);
  summary.failed = flagged(kFailed);
  summary.extrapolated = flagged(kExtrapolated);
  summary.truncated_path = flagged(kTruncatedPath);
  summary.near_singular = flagged(kNearSingular);
  summary.depth_max_m = largest_of(tool.depth_max_m);
  summary.force_max_n = largest_of(tool.force_max_n);
  summary.stiffness_max_n_per_m = largest_of(tool.stiffness_max_n_per_m);
  summary.error_relative_max = largest_of(tool.error_relative_max);
  summary.direction_spread_max_rad = largest_of(tool.direction_spread_max_rad);
  summary.relaxation = tool.relaxation;
  summary.yielding = tool.yielding_rows ? "differs from node to node"
                                        : describe(tool.viscoelasticity.yielding);
  if (tool.viscoelasticity.remembers() || tool.yielding_rows) {
    summary.viscoelasticity = tool.viscoelasticity;
    if (!tool.viscoelasticity.empty()) {
      summary.shares = share_extent(tool);
    }
    summary.memory_sites = tool.memory_sites;
  }
  summary.compliance = tool.compliance;
  summary.puncture = tool.puncture;
  summary.contact = tool.has_pressure ? "pressure" : "";
  if (tool.has_lateral) {
    summary.contact +=
        summary.contact.empty() ? "lateral stiffness" : ", lateral stiffness";
  }
  summary.accuracy = tool.accuracy;
  return summary;
}

double spacing_in_contact_radii(const ToolSummary& tool) {
  return tool.memory_sites > 0 && tool.depth_max_m > 0.0
             ? tool.viscoelasticity.sites.spacing_m /
                   contact_radius_m(tool.tool, 0.5 * tool.depth_max_m)
             : 0.0;
}

std::string describe_memory(const ToolSummary& tool) {
  std::string text = describe_memory(tool.viscoelasticity, tool.memory_sites);
  if (const double radii = spacing_in_contact_radii(tool); radii > 0.0) {
    text += fmt::format(", {:.2g} contact radii of a press to half the largest depth",
                        radii);
  }
  const std::string doubts = doubts_of_memory(tool);
  return text + (doubts.empty() ? "" : "; " + doubts);
}

std::string doubts_of_memory(const ToolSummary& tool) {
  if ((tool.viscoelasticity.empty() && tool.yielding.empty()) ||
      tool.depth_max_m == 0.0) {
    return {};
  }
  if (tool.memory_sites == 0) {
    return "a sliding force relaxes too little where nodes lie closer than two contact "
           "radii";
  }
  const double radii = spacing_in_contact_radii(tool);
  if (radii >= kFinestSites && radii <= kCoarsestSites) {
    return {};
  }
  return fmt::format("must be {} to {}: a sliding force relaxes too {}", kFinestSites,
                     kCoarsestSites, radii < kFinestSites ? "little" : "much");
}

std::string doubts_of_puncture(const ToolSummary& tool) {
  const std::string doubts = doubts_of(tool.puncture);
  const std::string deep = doubts_of_depth(tool.tool, tool.puncture, tool.depth_max_m);
  return doubts + (doubts.empty() || deep.empty() ? "" : "; ") + deep;
}

std::string describe_puncture(const ToolSummary& tool) {
  const std::string doubts = doubts_of_puncture(tool);
  return describe(tool.puncture) + (doubts.empty() ? "" : "; " + doubts);
}

std::string describe_depths(const AccuracyRecord& accuracy) {
  std::string text;
  for (std::size_t i = 0; i < accuracy.depth_share.size(); ++i) {
    text += fmt::format("{} {:.2g} of the depth on within {:.2g} %",
                        i == 0 ? "; from" : ", from", accuracy.depth_share[i],
                        100.0 * accuracy.covering_relative[i]);
  }
  return text;
}

std::string describe(const AccuracyRecord& accuracy) {
  const bool any_hard = accuracy.hard_error_factor > 0.0;
  const bool all_hard = any_hard && accuracy.error_factor == 0.0;
  if (accuracy.error_factor == 0.0 && !any_hard) {
    return {};
  }
  std::string factor =
      all_hard ? fmt::format("{:.2g} times estimates, as every path was hard to follow",
                             accuracy.hard_error_factor)
               : fmt::format("{:.2g} times estimates", accuracy.error_factor);
  if (any_hard && !all_hard) {
    factor += fmt::format(", {:.2g} times where the path was hard to follow",
                          accuracy.hard_error_factor);
  }
  if (accuracy.verified == 0) {
    return fmt::format(
        "meant to hold at {:.0f} % of places: {}; nothing was solved again to see",
        100.0 * kErrorCoverage, factor);
  }
  const char* const places = accuracy.between_nodes > 0 ? "places" : "nodes";
  const auto n = static_cast<std::size_t>(accuracy.verified);
  const double stated = all_hard ? accuracy.hard_covered : accuracy.covered;
  const double covered = stated > 0.0 ? stated : covered_share(n, n);
  std::string text = fmt::format(
      "hold at {:.0f} % of {}{}: {}, by {} {} that were solved again, better",
      100.0 * covered, places,
      accuracy.hard_covered > 0.0 && !all_hard
          ? fmt::format(", {:.0f} % where the path was hard to follow",
                        100.0 * accuracy.hard_covered)
          : "",
      factor, accuracy.verified, places);
  for (std::size_t i = 0; i < accuracy.quantile_level.size(); ++i) {
    if (accuracy.quantile_level[i] == 0.5) {
      text += fmt::format(
          "; there they differ by {:.2g} % in the median, {:.2g} % at most",
          100.0 * accuracy.error_relative[i], 100.0 * accuracy.error_relative.back());
    }
  }
  return text + describe_depths(accuracy);
}

}  // namespace palpate
