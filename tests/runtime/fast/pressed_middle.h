// A bench body under the element model, pressed at its middle.
#pragma once

#include <limits>

#include <Eigen/Core>

#include "runtime/bench/bench_body.h"
#include "runtime/fast/fast_step.h"
#include "tests/support/energy_account.h"

namespace palpate {

/// Without clamps.
inline FastState element_state(double radius_m = 0.005) {
  FastState state;
  state.config.tool_radius_m = radius_m;
  state.config.force_max_n = 1e6;
  state.config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  return state;
}

/// A flat body of one stiffness with a tool of no size, pressed at x.
inline FastState pressed(const BenchBody& body, const Eigen::Vector3d& x) {
  FastState state = element_state(0.0);
  send(state, body, x);
  return state;
}

inline Eigen::Vector3d over_middle(const BenchBody& body, double depth_m) {
  return {0.52 * body.side_m(), 0.51 * body.side_m(), -depth_m};
}

}  // namespace palpate
