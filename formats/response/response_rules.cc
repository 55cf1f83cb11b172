#include "formats/response/response_rules.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace palpate {
namespace {

// A unit vector to this accuracy: rounding of a normalisation, with room for float32.
constexpr double kUnitVectorTolerance = 1e-6;

bool is_unit(const Eigen::Vector3d& v) {
  return std::abs(v.norm() - 1.0) <= kUnitVectorTolerance;
}

std::string broken_sample(const NodeResponse& response) {
  const std::size_t n = response.depth_m.size();
  if (n < 2 || response.force_n.size() != n) {
    return fmt::format(
        "its curve has {} depths and {} forces, at least two of both "
        "are needed",
        n, response.force_n.size());
  }
  if (response.depth_m.front() != 0.0 || response.force_n.front() != 0.0) {
    return fmt::format("its curve begins at {} m and {} N, must begin at 0",
                       response.depth_m.front(), response.force_n.front());
  }
  for (std::size_t k = 0; k < n; ++k) {
    const double depth_m = response.depth_m[k];
    const double force_n = response.force_n[k];
    if (!std::isfinite(depth_m) || (k > 0 && !(depth_m > response.depth_m[k - 1]))) {
      return fmt::format("its depth at sample {} is {} m after {} m, must be larger", k,
                         depth_m, k > 0 ? response.depth_m[k - 1] : 0.0);
    }
    if (!std::isfinite(force_n) || !(force_n >= 0.0)) {
      return fmt::format(
          "its force at sample {} is {} N, must be finite and at least 0", k, force_n);
    }
  }
  const std::size_t directions = response.sample_direction.size();
  if (directions != 0 && directions != n) {
    return fmt::format("it has {} directions for {} samples", directions, n);
  }
  for (std::size_t k = 0; k < directions; ++k) {
    if (!is_unit(response.sample_direction[k])) {
      return fmt::format("its direction at sample {} has length {}, must be 1", k,
                         response.sample_direction[k].norm());
    }
  }
  if (response.tilt &&
      !(response.tilt->tilt.allFinite() && response.tilt->by_depth_per_m.allFinite())) {
    return "its tilt is not finite";
  }
  if (!response.contact.empty()) {
    const std::string wrong = broken_contact_row(response.contact, 0);
    return wrong.empty() ? "" : "it has a " + wrong;
  }
  return {};
}

}  // namespace

std::string broken_rule(const NodeResponse& response) {
  if (response.origin == ResponseOrigin::kNone) {
    return response.depth_m.empty() && response.force_n.empty() &&
                   response.sample_direction.empty() && !response.tilt
               ? ""
               : "it has samples, but no origin";
  }
  if (!is_unit(response.direction)) {
    return fmt::format("its direction has length {}, must be 1",
                       response.direction.norm());
  }
  if (!(response.direction_spread_rad >= 0.0 &&
        response.direction_spread_rad <= std::numbers::pi)) {
    return fmt::format("its direction turns by {} rad, must lie in [0, pi]",
                       response.direction_spread_rad);
  }
  if (!std::isfinite(response.touch_offset_m)) {
    return fmt::format("its touch offset is {} m", response.touch_offset_m);
  }
  if (!(response.error_relative >= 0.0) || !std::isfinite(response.error_relative)) {
    return fmt::format("its error is {}, must be finite and at least 0",
                       response.error_relative);
  }
  return broken_sample(response);
}

}  // namespace palpate
