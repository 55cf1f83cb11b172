#include "runtime/render/wire_watch.h"

#include <algorithm>
#include <cmath>

#include "runtime/realtime/clock.h"

namespace palpate {

void WireWatch::hold(std::int64_t now_ns, const Eigen::Vector3d& force_n) noexcept {
  held_[holds_++ % kHeldMax] = {now_ns, force_n};
}

// Over a time with an end, from the newest back; a force that is forgotten was as the
// oldest that is known.
Eigen::Vector3d WireWatch::mean_n(std::int64_t from_ns,
                                  std::int64_t to_ns) const noexcept {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::int64_t until_ns = to_ns;
  const std::size_t kept = std::min(holds_, kHeldMax);
  for (std::size_t i = 1; i <= kept && until_ns > from_ns; ++i) {
    const Held& held = held_[(holds_ - i) % kHeldMax];
    const std::int64_t since_ns = i == kept ? from_ns : std::max(from_ns, held.from_ns);
    if (since_ns < until_ns) {
      sum += static_cast<double>(until_ns - since_ns) * held.force_n;
      until_ns = since_ns;
    }
  }
  return sum / static_cast<double>(to_ns - from_ns);
}

double WireWatch::share(double held_s, double age_s) const noexcept {
  return limits_.stiffness_n_per_m * (0.5 * held_s + std::max(limits_.delay_s, age_s)) /
         limits_.damping_n_s_per_m;
}

void WireWatch::move(const Movement& movement, double available_j) noexcept {
  constexpr double kMemoryS = 0.05;
  constexpr double kHandW = 2e-3;
  constexpr double kFarTooSlow = 4.0;
  if (!std::isfinite(limits_.damping_n_s_per_m) || movement.to_ns <= movement.from_ns) {
    return;
  }
  const double held_s = seconds_in(movement.to_ns - movement.from_ns);
  const double age_s = seconds_in(movement.read_ns - movement.to_ns);
  const Eigen::Vector3d felt_n =
      mean_n(movement.from_ns, movement.to_ns) - movement.withheld_n;
  double gained_j = kHandW * held_s;
  if (felt_n != Eigen::Vector3d::Zero()) {
    gained_j += limits_.damping_n_s_per_m * movement.moved_m.squaredNorm() / held_s -
                felt_n.dot(movement.moved_m);
  }
  left_j_ = begun_ ? std::min(available_j, left_j_ + gained_j) : available_j;
  begun_ = true;
  const double part = -std::expm1(-held_s / kMemoryS);
  held_s_ += part * (held_s - held_s_);
  age_s_ += part * (age_s - age_s_);
  slow_ = share(held_s, age_s) > kFarTooSlow ? slow_ + 1 : 0;
}

Fault WireWatch::fault(bool in_contact) const noexcept {
  constexpr int kInARow = 4;
  const bool given = left_j_ < -0.25 * limits_.floor_j;
  if ((given && share(held_s_, age_s_) > 1.0) || (in_contact && slow_ >= kInARow)) {
    return Fault::kSlowWire;
  }
  return left_j_ < -limits_.floor_j ? Fault::kEnergy : Fault::kNone;
}

}  // namespace palpate
