#include "fitting/lateral/lateral_scene.h"

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

std::string lateral_scene(const IntervalEstimate& friction,
                          const IntervalEstimate& presliding_m) {
  if (!friction.refused.empty()) {
    throw InputError(
        fmt::format("a scene needs the friction coefficient, which was not found: {}",
                    friction.refused));
  }
  return fmt::format("[[tool]]  # add name, shape and lengths\nfriction = {:.6g}\n{}",
                     friction.value,
                     presliding_m.refused.empty()
                         ? fmt::format("presliding_m = {:.6g}\n", presliding_m.value)
                         : fmt::format("# presliding_m: {}\n", presliding_m.refused));
}

}  // namespace palpate
