#include "runtime/attach/hung_mass.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

constexpr double kFilterS = 0.01;      // of the velocity
constexpr double kRunawayM = 0.015;    // farther from its target than it began
constexpr double kRunawayMPerS = 0.5;  // the spring carries at some 0.02 m/s

// The spring and damper that carry the tool.
class Carrier {
 public:
  Carrier(const Eigen::Vector3d& centre_m, const WeighOptions& options)
      : centre_m_(centre_m), options_(options) {}

  // The force for the tool at position_m, time_s from the start.
  Eigen::Vector3d force_n(const Eigen::Vector3d& position_m, double time_s) {
    if (!started_) {
      from_m_ = position_m;
      last_m_ = position_m;
      last_s_ = time_s;
      started_ = true;
    }
    const double dt_s = time_s - last_s_;
    if (dt_s > 0.0) {
      velocity_ +=
          (dt_s / (dt_s + kFilterS)) * ((position_m - last_m_) / dt_s - velocity_);
    }
    last_m_ = position_m;
    last_s_ = time_s;
    ran_away_ = ran_away_ || velocity_.norm() > kRunawayMPerS;
    const double share = std::min(1.0, 2.0 * time_s / options_.settle_s);
    Eigen::Vector3d target_m = from_m_ + share * (centre_m_ - from_m_);
    ran_away_ =
        ran_away_ || (position_m - centre_m_).norm() >
                         (from_m_ - centre_m_).norm() + options_.sweep_m + kRunawayM;
    const double phase = 2.0 * std::numbers::pi * time_s / options_.period_s;
    target_m.y() += share * options_.sweep_m * std::sin(phase);
    return share * (options_.stiffness_n_per_m * (target_m - position_m) -
                    options_.damping_n_s_per_m * velocity_);
  }

  // Away from where it is carried, or faster than that: the motors push the wrong way,
  // or nothing hangs in the spring.
  [[nodiscard]] bool ran_away() const { return ran_away_; }

 private:
  Eigen::Vector3d centre_m_;
  WeighOptions options_;
  bool started_ = false;
  bool ran_away_ = false;
  Eigen::Vector3d from_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d last_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  double last_s_ = 0.0;
};

// Mean of the impulses of whole periods.
Weight mean_weight(const std::vector<double>& impulse_n_s, double period_s) {
  Weight weight;
  const auto count = static_cast<double>(impulse_n_s.size());
  for (const double impulse : impulse_n_s) {
    weight.force_n += impulse / period_s / count;
  }
  double square = 0.0;
  for (const double impulse : impulse_n_s) {
    square += std::pow(impulse / period_s - weight.force_n, 2);
  }
  weight.sd_n = std::sqrt(square / (count * (count - 1.0)));
  return weight;
}

}  // namespace

Weight weigh(DeviceLink& link, const Eigen::Vector3d& centre_m,
             const WeighOptions& options, const std::atomic<bool>& stop) {
  Carrier carrier(centre_m, options);
  MonotonicClock clock;
  const std::int64_t begin_ns = clock.now_ns();
  std::vector<double> impulse_n_s(static_cast<std::size_t>(options.periods), 0.0);
  const double end_s = options.settle_s + options.periods * options.period_s;
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  std::int64_t exchanges = 0;
  std::int64_t answered = 0;
  for (double now_s = 0.0; now_s < end_s;) {
    if (stop) {
      throw Interrupted();
    }
    Eigen::Vector3d position_m;
    const LinkStatus status = link.transact(force_n, position_m);
    const double then_s = seconds_in(clock.now_ns() - begin_ns);
    // Impulse of the force that was held from now_s to then_s [N s], to the period of
    // the sweep in which the hold began.
    const double period = (now_s - options.settle_s) / options.period_s;
    if (period >= 0.0) {
      const auto at =
          std::min(impulse_n_s.size() - 1, static_cast<std::size_t>(period));
      impulse_n_s[at] += force_n.y() * (std::min(then_s, end_s) - now_s);
    }
    now_s = then_s;
    ++exchanges;
    if (status == LinkStatus::kLost) {
      throw DeviceError(fmt::format("{}: {}", link.name(), link.failure()));
    }
    if (status == LinkStatus::kOk) {
      ++answered;
      force_n = carrier.force_n(position_m, now_s);
      if (carrier.ran_away()) {
        static_cast<void>(link.transact(Eigen::Vector3d::Zero(), position_m));
        throw DeviceError(
            fmt::format("{}: the tool ran away from the spring that is to carry it; do "
                        "its motors push the wrong way?",
                        link.name()));
      }
    }
  }
  // An exchange without answer keeps the last force: the spring does not act meanwhile.
  if (answered * 2 < exchanges) {
    throw DeviceError(
        fmt::format("{}: {} of {} exchanges were answered, too few to weigh",
                    link.name(), answered, exchanges));
  }
  return mean_weight(impulse_n_s, options.period_s);
}

double factor_of(const Weight& bare, const Weight& loaded, double mass_kg, double& sd) {
  const double weight_n = mass_kg * kGravity;
  const double factor = (loaded.force_n - bare.force_n) / weight_n;
  sd = std::hypot(bare.sd_n, loaded.sd_n) / weight_n;
  if (!(factor >= 0.2 && factor <= 5.0)) {
    throw DeviceError(fmt::format(
        "calibration: {:.4g} N more were asked for with {:.4g} kg that weighs "
        "{:.4g} N: a factor of {:.3g}, must lie in [0.2, 5]; does it hang "
        "free, with the device's y axis upwards?",
        loaded.force_n - bare.force_n, mass_kg, weight_n, factor));
  }
  return factor;
}

}  // namespace palpate
