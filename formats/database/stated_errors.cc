#include "formats/database/stated_errors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "formats/base/quantile.h"

namespace palpate {
namespace {

bool is_hard(const NodeResponse& response) {
  return (response.flags & kNearSingular) != 0;
}

// (n) Whether a vertex is in an element with a hard one: so all of a place's estimates
// have one factor where one of them is of a hard node.
std::vector<char> in_hard_elements(const SurfaceMesh& body,
                                   std::span<const NodeResponse> response) {
  std::vector<char> beside(response.size(), 0);
  for (Eigen::Index t = 0; t < body.triangle.rows(); ++t) {
    bool any_hard = false;
    for (const std::int32_t v : body.triangle.row(t)) {
      any_hard = any_hard || is_hard(response[static_cast<std::size_t>(v)]);
    }
    for (const std::int32_t v : body.triangle.row(t)) {
      char& known = beside[static_cast<std::size_t>(v)];
      known = any_hard ? 1 : known;
    }
  }
  return beside;
}

// What checks found of one group, beside what was estimated there.
struct CheckedErrors {
  std::vector<double> estimate;
  std::vector<double> error;

  CheckedErrors(const SurfaceMesh& body, std::span<const PlaceCheck> checks,
                std::span<const NodeResponse> responses,
                const std::vector<char>& beside, bool hard) {
    for (const PlaceCheck& check : checks) {
      const CheckCorners corners(body, check);
      double blended = 0.0;
      bool any_hard = false;
      for (std::size_t j = 0; j < 3; ++j) {
        const double share = corners.share(static_cast<Eigen::Index>(j));
        const NodeResponse& response = responses[corners.vertex[j]];
        blended += share * response.error_relative;
        any_hard = any_hard || (share > 0.0 && is_hard(response));
      }
      if (check.place.triangle < 0) {
        any_hard = beside[corners.vertex.front()] != 0;
      }
      if (!std::isnan(check.found) && blended > 0.0 && any_hard == hard) {
        estimate.push_back(blended);
        error.push_back(check.error(check.found));
      }
    }
  }

  [[nodiscard]] ErrorFactor factor() const {
    const auto known = std::count_if(error.begin(), error.end(), [](double e) {
      return std::isfinite(e);
    });
    return {calibrate_errors(estimate, error),
            covered_share(static_cast<std::size_t>(known), error.size())};
  }
};

// What 95 % of places are within, by the depth from which on errors count.
void state_by_depth(std::span<const PlaceCheck> checks, AccuracyRecord& record) {
  for (std::size_t i = 0; i < kErrorsFrom.size(); ++i) {
    std::vector<double> found;
    for (const PlaceCheck& check : checks) {
      if (check.place.triangle >= 0 && !std::isnan(check.found)) {
        found.push_back(
            check.error(std::isinf(check.found) ? check.found : check.found_from[i]));
      }
    }
    const std::size_t count = found.size();
    const double covered = found.empty() ? 0.0 : covering(std::move(found));
    if (count >= kChecksToCalibrate && std::isfinite(covered)) {
      record.depth_share.push_back(kErrorsFrom[i]);
      record.covering_relative.push_back(covered);
    }
  }
}

}  // namespace

ErrorFactors state_errors(const SurfaceMesh& body, double budget,
                          std::span<const PlaceCheck> checks,
                          std::span<NodeResponse> responses) {
  const std::vector<char> beside = in_hard_elements(body, responses);
  const ErrorFactor easy =
      CheckedErrors(body, checks, responses, beside, false).factor();
  ErrorFactor hard = CheckedErrors(body, checks, responses, beside, true).factor();
  // A place between nodes of both kinds counts as easy.
  hard.factor = std::max(hard.factor, easy.factor);
  ErrorFactors used;
  for (std::size_t v = 0; v < responses.size(); ++v) {
    NodeResponse& response = responses[v];
    if (response.origin == ResponseOrigin::kNone) {
      continue;
    }
    const ErrorFactor& factor = beside[v] != 0 ? hard : easy;
    (beside[v] != 0 ? used.hard : used.easy) = factor;
    response.error_relative *= factor.factor;
    if (response.error_relative > budget) {
      response.flags = static_cast<std::uint8_t>(response.flags | kErrorOverBudget);
    }
  }
  return used;
}

AccuracyRecord accuracy_record(double budget, const ErrorFactors& factor,
                               std::span<const PlaceCheck> checks) {
  AccuracyRecord record{
      .budget_relative = budget,
      .error_factor = factor.easy.factor,
      .hard_error_factor = factor.hard.factor,
      .covered = factor.easy.covered,
      .hard_covered = factor.hard.factor > 0.0 ? factor.hard.covered : 0.0,
      .quantile_level = {},
      .error_relative = {}};
  // Checks that failed (infinite) or found nothing (NaN) are not among the quantiles.
  std::vector<double> verified;
  for (const PlaceCheck& check : checks) {
    if (std::isfinite(check.found)) {
      verified.push_back(check.found);
      record.between_nodes += check.place.triangle >= 0 ? 1 : 0;
    }
  }
  if (verified.empty()) {
    return record;
  }
  std::sort(verified.begin(), verified.end());
  record.verified = std::ssize(verified);
  record.quantile_level = {0.0, 0.25, 0.5, 0.75, 0.95, 1.0};
  for (const double level : record.quantile_level) {
    record.error_relative.push_back(quantile(verified, level));
  }
  state_by_depth(checks, record);
  return record;
}

}  // namespace palpate
