// The force of a contact along any path of lateral displacements. The contact remembers
// the places where the motion turned and which no larger motion has wiped out.
//
//   p = +-g(|xi_1 - a|) +- sum_k 2 g(|xi_(k+1) - xi_k| / 2)
//
// Symbols: p = q / S [-1, 1], g the curve from rest (contact_law.h), a the place
// without tangential force [m]. xi_k are the remembered turns, the last xi is the
// present place. Signs are those of the motion. This is Masing's rule with Madelung's
// memory: a motion that goes beyond the turn before the last forgets both.
#pragma once

#include <vector>

#include "fitting/lateral/contact_law.h"

namespace palpate {

struct FrictionState {
  double share = 0.0;  ///< p
  double by_log_k = 0.0, by_log_slip = 0.0;
  double by_zero = 0.0;      ///< [1/m] dp/da
  double from_m = 0.0;       ///< place where the present motion began, a from rest
  bool from_rest = true;     ///< else from a remembered turn, at twice the scale
  double stick_share = 0.0;  ///< [-] way since then over that until all slides
};

class FrictionHistory {
 public:
  FrictionHistory(const ContactCurve& curve, double zero_m);

  /// Moves straight to a place; small steps and one long step are the same.
  const FrictionState& move_to(double x_m);

 private:
  // A remembered turn, and p with its derivatives there.
  struct Turn {
    double x_m = 0.0;
    FrictionState state;
  };
  [[nodiscard]] FrictionState branch_to(double x_m) const;

  ContactCurve curve_;
  std::vector<Turn> turn_;  // the first is a
  double x_m_;              // present place
  FrictionState now_;
};

}  // namespace palpate
