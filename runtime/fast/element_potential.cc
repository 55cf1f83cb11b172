#include "runtime/fast/element_potential.h"

namespace palpate {

ElementResponse respond(const ElementModel& model, const ElementCache& cache,
                        const Vector3& x_m, CurvePieces& pieces) noexcept {
  ElementResponse response;
  if (model.slot < 0) {
    return response;
  }
  turn_to(pieces, cache, model.slot);
  const Element& element = cache.element[static_cast<std::size_t>(model.slot)];
  const Vector3& u = model.direction;
  const Vector3 offset = model.rest_m - x_m;
  const Real d = offset.dot(u);
  response.depth_m = d;
  for (std::size_t j = 0; j < 3; ++j) {
    const Real weight = model.area(static_cast<Eigen::Index>(j));
    const ElementNode& node = element.node[j];
    if (!(weight > 0.0) || node.samples == 0) {
      continue;
    }
    const Real d_j = d - model.touch_m[j] - model.shift_m;
    response.touching = response.touching || d_j + model.shift_m > 0.0;
    if (d_j > 0.0) {
      const ElementSample at = evaluate(pieces, node, j, d_j);
      response.loaded = true;
      response.normal_n += weight * at.force_n;
      response.stiffness_n_per_m += weight * at.stiffness_n_per_m;
      response.normal_j += weight * at.energy_j;
      response.extrapolated = response.extrapolated || at.extrapolated;
    }
  }
  const Vector3 deflection = -offset - model.slip_m;
  response.presliding_m = deflection - deflection.dot(u) * u;
  response.friction_j =
      0.5 * model.friction_n_per_m * response.presliding_m.squaredNorm();
  return response;
}

Vector3 force_n(const ElementModel& model, const ElementResponse& response) noexcept {
  return response.normal_n * model.direction -
         model.friction_n_per_m * response.presliding_m;
}

}  // namespace palpate
