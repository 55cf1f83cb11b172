#include "runtime/bench/paper_wall.h"

#include <cmath>

namespace palpate {
namespace {

constexpr double kKneeM = 0.005;  // end of the quadratic part

}  // namespace

SlowValue wall_response(double k_n_per_m, double x_m) noexcept {
  const double k = k_n_per_m;
  const double x = x_m;
  if (!(x > 0.0)) {
    return {x, 0.0, 0.0, 0.0};
  }
  if (x <= kKneeM) {
    return {x, 100.0 * k * x * x, 200.0 * k * x, 100.0 * k * x * x * x / 3.0};
  }
  const double knee_j = 100.0 * k * kKneeM * kKneeM * kKneeM / 3.0;
  const double knee_n = 100.0 * k * kKneeM * kKneeM;
  const double past = x - kKneeM;
  return {x, k * (x - kKneeM / 2.0), k, knee_j + (knee_n + 0.5 * k * past) * past};
}

double wall_depth_m(double k_n_per_m, double f_n) noexcept {
  const double knee_n = 100.0 * k_n_per_m * kKneeM * kKneeM;
  return f_n <= knee_n ? std::sqrt(f_n / (100.0 * k_n_per_m))
                       : f_n / k_n_per_m + kKneeM / 2.0;
}

}  // namespace palpate
