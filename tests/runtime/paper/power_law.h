// What the slow process would send of a force a x^p.
#pragma once

#include <cmath>

#include "runtime/paper/slow_value_curve.h"

namespace palpate {

/// f = a x^p [N], 0 outside.
inline SlowValue power_law(double a, double p, double x) {
  if (!(x > 0.0)) {
    return {x, 0.0, 0.0, 0.0};
  }
  const double f = a * std::pow(x, p);
  return {x, f, p * f / x, f * x / (p + 1.0)};
}

}  // namespace palpate
