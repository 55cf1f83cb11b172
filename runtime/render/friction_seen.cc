#include "runtime/render/friction_seen.h"

namespace palpate {

FrictionSeen friction_seen(const FastState& state) noexcept {
  if (!is_field(state.config.model)) {
    return {};
  }
  const PotentialModel& model = state.potential;
  return {.spring = model.spring, .tool_m = model.tool_m, .normal = model.place.normal};
}

}  // namespace palpate
