// The energy that a local model gives a hand, kept by the test alone.
#pragma once

#include <algorithm>

#include <Eigen/Core>

#include "runtime/bench/bench_body.h"
#include "runtime/fast/fast_step.h"

namespace palpate {

/// What the slow process would send for a tool at x [m].
inline void send(FastState& state, const BenchBody& body, const Eigen::Vector3d& x) {
  for (const Element& element : body.around(x)) {
    accept(state, element);
  }
}

/// Net work of the model on its way, from the potential before each step.
struct Account {
  double net_j = 0.0;
  double lowest_j = 0.0;
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  bool begun = false;

  FastCommand step(FastState& state, const Eigen::Vector3d& to, double dt_s = 0.0005) {
    if (begun) {
      net_j += potential_j(state, to) - potential_j(state, x);
    }
    begun = true;
    x = to;
    lowest_j = std::min(lowest_j, net_j);
    return palpate::step(state, {to, 0}, dt_s);
  }
};

}  // namespace palpate
