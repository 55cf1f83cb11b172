// How often the intervals of fits hold what is true.
#pragma once

#include <cmath>
#include <map>
#include <string>

#include <fmt/format.h>

#include "fitting/numerics/interval_estimate.h"

namespace palpate {

/// By the name of the quantity.
struct IntervalCoverage {
  struct Held {
    int held = 0, of = 0, refused = 0;
    double squares = 0.0;  // of errors over standard deviations
  };
  std::map<std::string, Held> quantity;

  void add(const std::string& name, const IntervalEstimate& e, double truth) {
    Held& h = quantity[name];
    if (!e.refused.empty()) {
      ++h.refused;
      return;
    }
    ++h.of;
    h.held += e.low <= truth && truth <= e.high ? 1 : 0;
    h.squares += (e.value - truth) * (e.value - truth) / (e.sd * e.sd);
  }

  /// A line for each quantity.
  void print() const {
    for (const auto& [name, one] : quantity) {
      fmt::print("  {:<22} {:.3f} of {} ({} refused), errors {:.2f} of stated\n", name,
                 static_cast<double>(one.held) / one.of, one.of, one.refused,
                 std::sqrt(one.squares / one.of));
    }
  }
};

}  // namespace palpate
