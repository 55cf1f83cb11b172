// An emulated service whose tool nobody holds, and who pushes it.
#pragma once

#include <cstdint>
#include <functional>

#include <Eigen/Core>

#include "runtime/inverse/emulated_inverse.h"
#include "runtime/realtime/clock.h"

namespace palpate {

inline const Eigen::Vector3d kPush(0.5, 0.25, -1.0);

inline EmulatedInverseConfig free_tool_config() {
  EmulatedInverseConfig config;
  config.dynamics.hand_n_per_m = 0.0;
  config.dynamics.hand_n_s_per_m = 5.0;
  return config;
}

/// Within five seconds.
inline bool becomes(const std::function<bool()>& what) {
  MonotonicClock clock;
  const std::int64_t until_ns = clock.now_ns() + 5'000'000'000;
  while (!what() && clock.now_ns() < until_ns) {
    clock.sleep_until_ns(clock.now_ns() + 200'000);
  }
  return what();
}

}  // namespace palpate
