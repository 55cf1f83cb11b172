#include "runtime/attach/probe_wire.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kLeastStepM = 1e-8;  // float32 of a workspace's coordinates
constexpr double kSpeedS = 0.01;      // over which a speed is taken
constexpr double kProgressS = 1.0;

}  // namespace

void ProbeWire::begin_step(double planned_s) {
  step_ns_ = clock_.now_ns();
  step_s_ = planned_s;
  left_s_ -= planned_s;
}

void ProbeWire::begin_motion() {
  begin_ns_ = clock_.now_ns();
  next_ns_ = begin_ns_;
  begun_s_ = 0.0;
  gap_s_ = 0.0;
  from_m_ = position_m_;
}

double ProbeWire::motion_s() {
  return seconds_in(clock_.now_ns() - begin_ns_);
}

void ProbeWire::begin_pushing(int axis) {
  if (!free_) {
    origin_m_ = position_m_;
    free_ = true;
  }
  axis_ = axis;
}

double ProbeWire::step_m() const {
  return std::isfinite(resolution_m_) ? resolution_m_ : 0.0;
}

bool ProbeWire::rests(double within_s, double for_s) {
  begin_motion();
  double stood_since_s = 0.0;
  while (motion_s() - stood_since_s < for_s) {
    const Eigen::Vector3d before_m = position_m_;
    static_cast<void>(paced(0.0));
    if ((position_m_ - before_m).norm() > 1.5 * step_m()) {
      stood_since_s = motion_s();
    }
    if (motion_s() > within_s) {
      return false;
    }
  }
  return true;
}

bool ProbeWire::paced(double force_n) {
  clock_.sleep_until_ns(next_ns_);
  next_ns_ += std::llround(kNanosecondsPerSecond / options_.rate_hz);
  const double before_s = begun_s_;
  begun_s_ = motion_s();
  const bool answered = exchange(force_n);
  gap_s_ = std::max({gap_s_, begun_s_ - before_s, motion_s() - begun_s_});
  return answered;
}

bool ProbeWire::exchange(double force_n) {
  if (guide_.stopped && guide_.stopped()) {
    throw Interrupted();
  }
  show_progress();
  const double within_n = std::clamp(force_n, -options_.force_n, options_.force_n);
  Eigen::Vector3d position_m;
  const std::int64_t start_ns = clock_.now_ns();
  const LinkStatus status =
      link_.transact(within_n * Eigen::Vector3d::Unit(axis_), position_m);
  exchange_.add(clock_.now_ns() - start_ns);
  ++exchanges_;
  force_max_n_ = std::max(force_max_n_, std::abs(within_n));
  if (status == LinkStatus::kLost) {
    throw DeviceError(fmt::format("{}: {}", link_.name(), link_.failure()));
  }
  if (status == LinkStatus::kMissed) {
    ++missed_;
    return false;
  }
  // The first answer has no position before it.
  if (exchanges_ > missed_ + 1) {
    learn_step(position_m - position_m_);
  }
  position_m_ = position_m;
  if (free_) {
    stop_a_runaway(start_ns);
  }
  return true;
}

void ProbeWire::let_go() noexcept {
  Eigen::Vector3d ignored;
  static_cast<void>(link_.transact(Eigen::Vector3d::Zero(), ignored));
}

// Of encoders on legs a count moves the tool aslant: its length is what counts.
void ProbeWire::learn_step(const Eigen::Vector3d& moved_m) {
  if (moved_m.norm() > kLeastStepM) {
    resolution_m_ = std::min(resolution_m_, moved_m.norm());
  }
}

void ProbeWire::stop_a_runaway(std::int64_t now_ns) {
  const double far_m = (position_m_ - origin_m_).norm();
  if (far_m > options_.runaway_m) {
    throw DeviceError(fmt::format("{}: the tool ran away by {:.3g} mm and was let go",
                                  link_.name(), 1e3 * far_m));
  }
  const double dt_s = seconds_in(now_ns - speed_ns_);
  if (dt_s < kSpeedS) {
    return;
  }
  const double speed_m_per_s = (position_m_ - speed_m_).norm() / dt_s;
  if (dt_s < 2.0 * kSpeedS && speed_m_per_s > options_.runaway_m_per_s) {
    throw DeviceError(fmt::format("{}: the tool ran away at {:.3g} m/s and was let go",
                                  link_.name(), speed_m_per_s));
  }
  speed_ns_ = now_ns;
  speed_m_ = position_m_;
}

void ProbeWire::show_progress() {
  const std::int64_t now_ns = clock_.now_ns();
  if (guide_.progress && now_ns >= progress_ns_) {
    progress_ns_ = now_ns + std::llround(kProgressS * kNanosecondsPerSecond);
    guide_.progress(left_s_ + std::max(0.0, step_s_ - seconds_in(now_ns - step_ns_)));
  }
}

void ProbeWire::report(ProbeReport& report) const {
  report.exchanges = exchanges_;
  report.missed = missed_;
  report.force_max_n = force_max_n_;
  report.resolution_m = step_m();
  report.exchange_p50_s = exchange_s(0.5);
  report.exchange_p99_s = exchange_s(0.99);
  report.exchange_max_s = exchange_.max_ns() / kNanosecondsPerSecond;
}

}  // namespace palpate
