#include "fitting/lateral/lateral_scene.h"

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

std::string lateral_scene(const LateralFit& fit) {
  const IntervalEstimate& friction = fit.better.friction;
  const IntervalEstimate& presliding = fit.better.presliding_m;
  if (!friction.refused.empty()) {
    throw InputError(
        fmt::format("a scene needs the friction coefficient, which was not found: {}",
                    friction.refused));
  }
  return fmt::format("[[tool]]  # add name, shape and lengths\nfriction = {:.6g}\n{}",
                     friction.value,
                     presliding.refused.empty()
                         ? fmt::format("presliding_m = {:.6g}\n", presliding.value)
                         : fmt::format("# presliding_m: {}\n", presliding.refused));
}

}  // namespace palpate
