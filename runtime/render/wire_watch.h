// What a device's wire does to a hand while it is rendered. The account of the local
// model (fast/passivity_ledger.h) cannot see a wire: it books positions as they come,
// and forces act as long as the wire holds them.
#pragma once

#include <cstdint>
#include <limits>

#include <Eigen/Core>

#include "runtime/fast/safety.h"

namespace palpate {

struct WireLimits {
  /// [N s/m] >= 0 of the mechanism, as its driver says, and of what else takes a held
  /// force's gain; infinite: nobody looks at the wire.
  double damping_n_s_per_m = std::numeric_limits<double>::infinity();
  double stiffness_n_per_m = 0.0;  ///< [N/m] >= 0 largest that is rendered
  double delay_s = 0.0;            ///< [s] >= 0 from command to force
  double floor_j = 0.01;           ///< [J] > 0 that a hand may be given
};

/// A passivity observer (Hannaford & Ryu 2002) on forces as they were held, F of the
/// movement dx in the time dt that the wire took for it:
///
///   left <- min(available, left - F dx + b |dx|^2 / dt)
///
/// available is what the model could give back. So what the hand put in, and what the
/// mechanism's damping took, pays for what it gets; what friction took before is lent
/// to nobody. By a wire that is as fast as the bound demands (stability_margin.h) left
/// stays at or above zero, because a held force gives K |dx|^2 / 2 at most.
class WireWatch {
 public:
  explicit WireWatch(const WireLimits& limits) : limits_(limits) {}

  /// @param felt_n [N] on the tool since the last call. @param moved_m [m] since then.
  /// @param held_s [s] >= 0 between the two measurements; 0: it is the same one.
  /// @param available_j [J] >= 0 in the model.
  void add(const Eigen::Vector3d& felt_n, const Eigen::Vector3d& moved_m, double held_s,
           double available_j) noexcept;

  /// kEnergy where the hand was given more than the floor; kSlowWire where the wire has
  /// held forces too long for the stiffness meanwhile; else kNone.
  [[nodiscard]] Fault fault() const noexcept;

  /// [s] that a force is held, of the latest 50 ms: mean over time.
  [[nodiscard]] double held_s() const noexcept { return held_s_; }

 private:
  WireLimits limits_;
  bool begun_ = false;
  double left_j_ = 0.0;
  double held_s_ = 0.0;
};

}  // namespace palpate
