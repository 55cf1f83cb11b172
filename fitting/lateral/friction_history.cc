#include "fitting/lateral/friction_history.h"

#include <cmath>

namespace palpate {

FrictionHistory::FrictionHistory(const ContactCurve& curve, double zero_m)
    : curve_(curve), turn_{{zero_m, {}}}, x_m_(zero_m) {}

// From the last turn: from rest at the curve's own scale, else at twice.
FrictionState FrictionHistory::branch_to(double x_m) const {
  const Turn& last = turn_.back();
  const bool from_rest = turn_.size() == 1;
  const double scale = from_rest ? 1.0 : 2.0;
  const double way = x_m - last.x_m, sign = std::copysign(scale, way);
  const double u = std::abs(way) / scale;
  const CurveShare g = force_share(curve_, u);
  FrictionState state = last.state;
  state.share += sign * g.value;
  state.by_log_k += sign * g.by_log_k;
  state.by_log_slip += sign * g.by_log_slip;
  // A turn that is remembered stands where it is; only rest moves with a.
  state.by_zero += from_rest ? -g.by_u : 0.0;
  state.from_m = last.x_m;
  state.from_rest = from_rest;
  state.stick_share = u / curve_.slides_at_m();
  return state;
}

const FrictionState& FrictionHistory::move_to(double x_m) {
  const double back = x_m_ - turn_.back().x_m, ahead = x_m - x_m_;
  if (back * ahead < 0.0) {
    turn_.push_back({x_m_, now_});  // the motion turns here
  }
  // Beyond the turn before the last, the last two are forgotten; beyond the mirror
  // image of the only turn, that one.
  while (turn_.size() > 1) {
    const std::size_t last = turn_.size() - 1;
    const double way = std::abs(x_m - turn_[last].x_m);
    const double before = std::abs(turn_[last].x_m - turn_[last - 1].x_m);
    if (!(way >= (last == 1 ? 2.0 * before : before))) {
      break;
    }
    turn_.resize(last == 1 ? 1 : last - 1);
  }
  x_m_ = x_m;
  now_ = branch_to(x_m);
  return now_;
}

}  // namespace palpate
