#include "runtime/render/friction_seen.h"

namespace palpate {
namespace {

std::array<double, 3> three(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

FrictionSeen friction_seen(const FastState& state) noexcept {
  const FrictionSpring& spring = state.potential.spring;
  if (!is_field(state.config.model) || !(spring.n_per_m > 0.0)) {
    return {};
  }
  return {.n_per_m = spring.n_per_m,
          .limit_n = spring.limit_n,
          .stretch_m = three(spring.stretch_m),
          .force_n = three(spring.force_n()),
          .tool_m = three(state.potential.tool_m),
          .normal = three(state.potential.place.normal)};
}

}  // namespace palpate
