#include "runtime/fast/friction_spring.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate {

void set_spring(FrictionSpring& spring, const FieldPlace& place,
                const ElementCache& cache, Real normal_n) noexcept {
  const Element& element = cache.element[static_cast<std::size_t>(place.slot)];
  Real coefficient = 0.0;
  Real presliding_m = 0.0;
  for (std::size_t j = 0; j < 3; ++j) {
    const Real weight = std::max(Real(0.0), place.weight(static_cast<Eigen::Index>(j)));
    coefficient += weight * element.node[j].friction;
    presliding_m += weight * element.node[j].presliding_m;
  }
  if (!(coefficient > 0.0 && presliding_m > 0.0)) {
    spring = {};
    return;
  }
  const Real before = spring.n_per_m;
  const Real now = coefficient * std::max(Real(0.0), normal_n) / presliding_m;
  spring.n_per_m = now;
  Vector3& t = spring.stretch_m;
  const Real length2 = t.squaredNorm();
  if (!(length2 > 0.0)) {
    return;
  }
  const Vector3& n = place.normal;
  t -= t.dot(n) * n;
  const Real in_plane2 = t.squaredNorm();
  const Real kept2 = now > before ? length2 * before / now : length2;  // (23)
  const Real limit2 = presliding_m * presliding_m;
  if (in_plane2 > 0.0) {
    t *= std::sqrt(std::min(kept2, limit2) / in_plane2);
  }
}

}  // namespace palpate
