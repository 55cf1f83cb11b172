// Places where a test can spoil a node's numbers, or throw, to see that a fault stays
// that node's own.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

namespace palpate {

enum class FaultPlace {
  kWorker,         ///< before a node is pressed; no numbers
  kPress,          ///< forces of a linear press [N], a sample's three at a time
  kCorrection,     ///< forces of a nonlinear press [N], likewise
  kRatio,          ///< of full and linear forces along a path [-]
  kInterpolation,  ///< forces of an interpolated response [N]
};

/// May change the numbers, or throw anything.
using FaultMaker = std::function<void(FaultPlace place, std::int32_t vertex,
                                      std::span<double> numbers)>;

/// From now on every fault_point() calls it, from any thread; empty: none does. Not to
/// be called while somebody computes.
void set_fault_maker(FaultMaker maker);

void fault_point(FaultPlace place, std::int32_t vertex, std::span<double> numbers = {});

}  // namespace palpate
