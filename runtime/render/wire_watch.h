// What a device's wire does to a hand while it is rendered. The account of the local
// model (fast/passivity_ledger.h) cannot see a wire: it books positions as they come,
// and forces act as long as the wire holds them.
#pragma once

#include <array>
#include <cstddef>
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
///   left <- min(available, left - F dx + b |dx|^2 / dt + p dt)
///
/// available is what the model could give back, b counts while a force acts, p is 2 mW,
/// which any hand takes. So what the hand put in, and what the mechanism's damping
/// took, pays for what it gets; what friction took before is lent to nobody. By a wire
/// that is as fast as the bound demands (stability_margin.h) left stays at zero or
/// above it, because a held force gives K |dx|^2 / 2 at most.
class WireWatch {
 public:
  explicit WireWatch(const WireLimits& limits) : limits_(limits) {}

  /// Holds a force on the tool from then on. @param now_ns as of positions, not
  /// falling.
  void hold(std::int64_t now_ns, const Eigen::Vector3d& force_n) noexcept;

  /// A position came. @param from_ns, to_ns when it and the last were measured; the
  /// same one: nothing has moved. @param withheld_n [N] that the driver could not
  /// render of what acted. @param available_j [J] >= 0 in the model.
  void move(std::int64_t from_ns, std::int64_t to_ns, const Eigen::Vector3d& moved_m,
            const Eigen::Vector3d& withheld_n, double available_j) noexcept;

  /// kSlowWire where the wire holds forces too long for the stiffness, and the hand was
  /// given a quarter of the floor; kEnergy where it was given more than the floor; else
  /// kNone.
  [[nodiscard]] Fault fault() const noexcept;

  /// [s] that a force is held, of the latest 50 ms: mean over time.
  [[nodiscard]] double held_s() const noexcept { return held_s_; }

 private:
  struct Held {
    std::int64_t from_ns = 0;
    Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  };
  static constexpr std::size_t kHeldMax = 1024;

  [[nodiscard]] Eigen::Vector3d mean_n(std::int64_t from_ns,
                                       std::int64_t to_ns) const noexcept;

  WireLimits limits_;
  std::array<Held, kHeldMax> held_{};
  std::size_t holds_ = 0;
  bool begun_ = false;
  double left_j_ = 0.0;
  double held_s_ = 0.0;
};

}  // namespace palpate
