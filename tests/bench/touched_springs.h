// A convex response as springs that are touched one after another, each with a memory
// of its own. The model is the method of dimensionality reduction (Popov & Hess).
// Bundles of a curve are measured by this model.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/support/relaxation_reference.h"

namespace palpate {

/// f = 2 N (d / 5 mm)^1.5.
class TouchedSprings {
 public:
  explicit TouchedSprings(const PronyTerms2& terms) : terms_(terms) {}

  // Force [N] at a depth, after a step of time.
  double step(double depth_m, double dt_s) {
    constexpr int kCount = 4000;
    constexpr double kDeepestM = 0.008;
    relaxed_n_.resize(kCount, {0.0, 0.0});
    double force_n = 0.0;
    for (int i = 0; i < kCount; ++i) {
      const double begin_m = kDeepestM * i / kCount;
      const double end_m = kDeepestM * (i + 1) / kCount;
      const double stiffness = slope(end_m) - slope(begin_m);
      const double e = stiffness * std::max(0.0, depth_m - 0.5 * (begin_m + end_m));
      auto& q = relaxed_n_[static_cast<std::size_t>(i)];
      const double s = terms_.g[0] * q[0] + terms_.g[1] * q[1];
      const double p = std::max(e, s);
      force_n += p - s;
      for (std::size_t k = 0; k < 2; ++k) {
        q[k] = p + std::exp(-dt_s / terms_.tau_s[k]) * (q[k] - p);
      }
    }
    return force_n;
  }

 private:
  static double slope(double d) { return 3.0 / 0.005 * std::sqrt(d / 0.005); }
  PronyTerms2 terms_;
  std::vector<std::array<double, 2>> relaxed_n_;
};

}  // namespace palpate
