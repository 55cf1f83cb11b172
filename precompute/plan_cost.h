// Entries of a plan's cost: what is done once, and what is timed on a few of many.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "precompute/plan.h"

namespace palpate {

/// Work done once. @param times longer than what was timed in its place.
[[nodiscard]] inline PlanCost cost_once(const std::string& work, double timed_seconds,
                                        double times = 1.0) {
  return {work, 1, 1, timed_seconds, times * timed_seconds};
}

/// `timed` of `count` pieces of work. @param times longer than a timed one each takes.
[[nodiscard]] inline PlanCost cost_of_all(const std::string& work, std::size_t count,
                                          std::size_t timed, double timed_seconds,
                                          double times = 1.0) {
  const double share = static_cast<double>(count) / static_cast<double>(timed);
  return {work, static_cast<std::int64_t>(count), static_cast<std::int64_t>(timed),
          timed_seconds, times * share * timed_seconds};
}

}  // namespace palpate
