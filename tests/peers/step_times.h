// What a tick of a renderer costs.
#pragma once

#include <limits>
#include <span>
#include <string>

#include "tests/peers/loaded_renderer.h"
#include "tests/peers/scene_folder.h"

namespace palpate::peers {

/// NaN: not measured.
struct StepTimes {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double median_us = kNone;       ///< [us] of peer_pose() and peer_force() together
  double p999_us = kNone;         ///< [us] 99.9th percentile
  double slow_median_us = kNone;  ///< [us] of peer_slow()
  double allocations = kNone;     ///< of the heap, per tick, mean
};

/// Along the hands, each several times; of each number the least over the repeats, as
/// other work on the machine only adds. Times are less an empty reading of the clock.
[[nodiscard]] StepTimes step_times(const Renderer& renderer, const std::string& variant,
                                   const PeerScene& scene,
                                   const std::filesystem::path& own,
                                   std::span<const Hand* const> hands);

}  // namespace palpate::peers
