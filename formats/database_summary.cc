#include "formats/database_summary.h"

#include <algorithm>

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
  summary.depth_max_m = table.depth_max_m();
  summary.force_max_n = largest_of(table.force_n);
  summary.stiffness_max_n_per_m = largest_of(table.stiffness_max_n_per_m);
  summary.error_relative_max = largest_of(table.error_relative);
  summary.direction_spread_max_rad = largest_of(table.direction_spread_rad);
  return summary;
}

}  // namespace palpate
