#include "runtime/render/wire_watch.h"

#include <algorithm>
#include <cmath>

namespace palpate {

void WireWatch::add(const Eigen::Vector3d& felt_n, const Eigen::Vector3d& moved_m,
                    double held_s, double available_j) noexcept {
  constexpr double kMemoryS = 0.05;
  if (!std::isfinite(limits_.damping_n_s_per_m)) {
    return;
  }
  double gained_j = -felt_n.dot(moved_m);
  if (held_s > 0.0) {
    gained_j += limits_.damping_n_s_per_m * moved_m.squaredNorm() / held_s;
    held_s_ += (held_s - held_s_) * -std::expm1(-held_s / kMemoryS);
  }
  left_j_ = begun_ ? std::min(available_j, left_j_ + gained_j) : available_j;
  begun_ = true;
}

Fault WireWatch::fault() const noexcept {
  if (!(left_j_ < -limits_.floor_j)) {
    return Fault::kNone;
  }
  const double share = limits_.stiffness_n_per_m * (0.5 * held_s_ + limits_.delay_s);
  return share > limits_.damping_n_s_per_m ? Fault::kSlowWire : Fault::kEnergy;
}

}  // namespace palpate
