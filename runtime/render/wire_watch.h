// What a device's wire does to a hand while it is rendered. The account of the local
// model (account/passivity_ledger.h) cannot see a wire. The account books positions as
// they come, and forces act as long as the wire holds them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <Eigen/Core>

#include "runtime/account/safety.h"

namespace palpate {

struct WireLimits {
  /// [N s/m] >= 0 of the mechanism, as its driver says, and of what else takes a held
  /// force's gain; infinite: nobody looks at the wire.
  double damping_n_s_per_m = std::numeric_limits<double>::infinity();
  double stiffness_n_per_m = 0.0;  ///< [N/m] >= 0 largest that is rendered
  double delay_s = 0.0;            ///< [s] >= 0 from command to force
  double floor_j = 0.01;           ///< [J] > 0 that a hand may be given
};

/// A passivity observer (Hannaford & Ryu 2002) on forces as they were held. F is the
/// force held during the movement dx, and dt the time that the wire took for the
/// movement:
///
///   left <- min(available, left - F dx + b |dx|^2 / dt + p dt)
///
/// available is what the model could give back, b counts while a force acts, p is 2 mW,
/// which any hand takes. So what the hand put in, and what the mechanism's damping
/// took, pays for what it gets; what friction took before is credited to nobody. By a
/// wire that is as fast as the bound demands (stability_margin.h), left stays at zero
/// or above it. The reason is that a held force gives K |dx|^2 / 2 at most.
class WireWatch {
 public:
  explicit WireWatch(const WireLimits& limits = {}) : limits_(limits) {}

  /// Other limits; what the wire has done so far still counts.
  void limit(const WireLimits& limits) noexcept { limits_ = limits; }

  /// Holds a force on the tool from then on. @param now_ns as of positions, not
  /// falling.
  void hold(std::int64_t now_ns, const Eigen::Vector3d& force_n) noexcept;

  struct Movement {
    std::int64_t from_ns = 0;  ///< when the position before was measured
    std::int64_t to_ns = 0;    ///< and this one; the same: nothing has moved
    std::int64_t read_ns = 0;  ///< when this one was known
    Eigen::Vector3d moved_m = Eigen::Vector3d::Zero();
    /// [N] that the driver could not render of what acted.
    Eigen::Vector3d withheld_n = Eigen::Vector3d::Zero();
  };

  /// A position came. @param available_j [J] >= 0 in the model.
  void move(const Movement& movement, double available_j) noexcept;

  /// kSlowWire where K (T/2 + delay) > b. T is the time that forces are held, and delay
  /// the driver's or the age of positions, if that is more. The mean of 50 ms counts if
  /// the hand was given a quarter of the floor. In contact the fault comes at once
  /// where K (T/2 + delay) was four times b in the latest four positions. kEnergy where
  /// the hand was given more than the floor; else kNone.
  [[nodiscard]] Fault fault(bool in_contact) const noexcept;

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
  // K (T/2 + delay) / b
  [[nodiscard]] double share(double held_s, double age_s) const noexcept;

  WireLimits limits_;
  std::array<Held, kHeldMax> held_{};
  std::size_t holds_ = 0;
  bool begun_ = false;
  double left_j_ = 0.0;
  double held_s_ = 0.0;
  double age_s_ = 0.0;  // of positions when they are known, likewise
  int slow_ = 0;        // positions in a row
};

}  // namespace palpate
