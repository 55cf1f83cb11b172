#include "tests/bench/runtime/wire_energy.h"

#include <algorithm>
#include <cmath>

#include "runtime/realtime/clock.h"

namespace palpate {

WireEnergy wire_energy(std::span<const MotorRecord> trace, double k_n_per_m,
                       double age_s, double resolution_m) {
  WireEnergy energy;
  const auto age_ns = std::llround(age_s * kNanosecondsPerSecond);
  double bound_j = 0.0;
  std::size_t driven = 0;  // the first record with force that is not before `i`
  std::size_t aged = 0;    // the last record that is A before `i`, or the first
  for (std::size_t i = 1; i < trace.size(); ++i) {
    const MotorRecord& before = trace[i - 1];
    const MotorRecord& now = trace[i];
    for (driven = std::max(driven, i - 1);
         driven < trace.size() && trace[driven].force_n == 0.0;) {
      ++driven;
    }
    while (aged + 1 < i && trace[aged + 1].time_ns <= now.time_ns - age_ns) {
      ++aged;
    }
    if (driven < trace.size() && trace[driven].time_ns - now.time_ns <= age_ns) {
      bound_j += k_n_per_m *
                 (age_s * (now.squared_speed_m2_per_s - before.squared_speed_m2_per_s) +
                  2.0 * resolution_m * (now.path_m - before.path_m));
    }
    const double allowed_j =
        bound_j + before.force_n * (now.path_m - trace[aged].path_m + resolution_m);
    energy.given_max_j = std::max(energy.given_max_j, now.work_j);
    energy.margin_min_j = std::min(energy.margin_min_j, allowed_j - now.work_j);
    energy.bound_end_j = allowed_j;
  }
  if (!trace.empty()) {
    energy.given_end_j = trace.back().work_j;
    energy.squared_speed_m2_per_s = trace.back().squared_speed_m2_per_s;
    energy.path_m = trace.back().path_m;
  }
  return energy;
}

}  // namespace palpate
