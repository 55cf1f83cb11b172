#include "runtime/render/needle_seen.h"

namespace palpate {

NeedleSeen needle_seen(const FastState& state) noexcept {
  NeedleSeen seen;
  if (!is_needle(state.config.puncture)) {
    return seen;
  }
  seen.punctures = true;
  seen.state = state.needle;
  if (const Channel* in = channel_of(state.needle)) {
    seen.tip_m = in->tip_m(state.latest.position_m);
    seen.inserted_m = in->inserted_m;
    seen.tip_n = tip_n(*in, state.potential);
    const Vector3 held = held_n(state.config.puncture, *in);
    seen.shaft_n = in->axis.dot(held);
    seen.lateral_n = held - in->axis.dot(held) * in->axis;
  }
  return seen;
}

}  // namespace palpate
