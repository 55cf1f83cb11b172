// Bodies that yield: what the tests of the fast step share.
#pragma once

#include <random>
#include <vector>

#include "tests/support/relaxing_body.h"

namespace palpate {

inline constexpr NodeYielding kDenting{.yield_depth_m = 0.001, .share = 0.4};
inline constexpr NodeYielding kSoftening{
    .onset_m = 0.001, .scale_m = 0.002, .largest = 0.5};
inline constexpr NodeYielding kBoth{.yield_depth_m = 0.001,
                                    .share = 0.4,
                                    .onset_m = 0.0015,
                                    .scale_m = 0.002,
                                    .largest = 0.5};

/// A body of nodes that all yield differently, around some parameters.
inline BenchBody mixed_body(BenchBodyOptions options, const NodeYielding& around) {
  options.yielding.reset();
  BenchBody body = make_bench_body(options);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> part(0.5, 1.5);
  std::vector<NodeYielding> by_node;
  for (int i = 0; i < (options.cells + 1) * (options.cells + 1); ++i) {
    by_node.push_back({.yield_depth_m = part(random) * around.yield_depth_m,
                       .share = part(random) * around.share,
                       .onset_m = part(random) * around.onset_m,
                       .scale_m = part(random) * around.scale_m,
                       .largest = part(random) * around.largest});
  }
  set_yielding(body, by_node);
  return body;
}

}  // namespace palpate
