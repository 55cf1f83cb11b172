#include "runtime/element/cubic_cache.h"

#include <algorithm>
#include <limits>

namespace palpate {

CurvePiece piece_around(const ElementCurve& curve, Real d) noexcept {
  const std::size_t last = curve.depth_m.size() - 1;
  if (d > curve.depth_m[last]) {
    return {.from_m = curve.depth_m[last],
            .to_m = std::numeric_limits<Real>::infinity(),
            .force_n = curve.force_n[last],
            .stiffness_n_per_m = std::max(Real(0.0), curve.stiffness_n_per_m[last]),
            .energy_j = curve.energy_j[last],
            .extrapolated = true};
  }
  const std::size_t i = curve.interval(d);
  const Real h = curve.depth_m[i + 1] - curve.depth_m[i];
  const Real m0 = curve.stiffness_n_per_m[i];
  const Real m1 = curve.stiffness_n_per_m[i + 1];
  const Real s = (curve.force_n[i + 1] - curve.force_n[i]) / h;
  return {.from_m = curve.depth_m[i],
          .to_m = curve.depth_m[i + 1],
          .force_n = curve.force_n[i],
          .stiffness_n_per_m = m0,
          .bend_n_per_m2 = (3.0 * s - 2.0 * m0 - m1) / h,
          .twist_n_per_m3 = (m0 + m1 - 2.0 * s) / (h * h),
          .energy_j = curve.energy_j[i]};
}

}  // namespace palpate
