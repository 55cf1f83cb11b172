#include "runtime/attach/sign_test.h"

#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kWatchS = 0.01;  // over which a speed is measured

}  // namespace

Eigen::Vector3d SignTest::next(const std::optional<Eigen::Vector3d>& position_m,
                               const Eigen::Vector3d& sent_n, std::int64_t now_ns) {
  if (!pushes_) {  // the exchange was at rest
    pushes_ = !passed();
    begin_ns_ = now_ns;
    watched_ = false;
    before_m_.reset();
  } else {
    if (position_m) {
      watch(*position_m, now_ns);
    }
    if (position_m && before_m_) {
      work_j_[static_cast<std::size_t>(axis_)] +=
          acting_n_.dot(*position_m - *before_m_);
    }
    before_m_ = position_m;
    acting_n_ = sent_n;
  }
  const double now_s = seconds_in(now_ns - begin_ns_);
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  if (pushes_ && now_s >= 2.0 * options_.period_s) {
    end_round();
  } else if (pushes_) {
    const double phase = 2.0 * std::numbers::pi * now_s / options_.period_s;
    force_n[axis_] =
        (now_s < options_.period_s ? 1.0 : -1.0) * options_.force_n * std::sin(phase);
  }
  return force_n;
}

void SignTest::watch(const Eigen::Vector3d& position_m, std::int64_t now_ns) {
  if (!std::exchange(watched_, true)) {
    begin_m_ = position_m;
    mark_m_ = position_m;
    mark_ns_ = now_ns;
  }
  bool ran = (position_m - begin_m_).norm() > options_.runaway_m;
  const double passed_s = seconds_in(now_ns - mark_ns_);
  if (passed_s > kWatchS) {
    ran = ran || (position_m - mark_m_).norm() > options_.runaway_m_per_s * passed_s;
    mark_m_ = position_m;
    mark_ns_ = now_ns;
  }
  if (ran) {
    throw DeviceError(fmt::format(
        "{}: the tool ran away by {:.3g} mm under {} N: hold it loosely in the "
        "middle and try again; if it runs again, its motors push the wrong way",
        name_, 1e3 * (position_m - begin_m_).norm(), options_.force_n));
  }
}

// W > clear_j: the motors push as they are asked to. Below -clear_j they push against
// it. Between, the next round adds to the sum.
void SignTest::end_round() {
  pushes_ = false;
  const double sum_j = work_j_[static_cast<std::size_t>(axis_)];
  if (sum_j > options_.clear_j) {
    ++axis_;
    round_ = 0;
    return;
  }
  if (++round_ < options_.rounds) {
    return;
  }
  throw DeviceError(
      sum_j < -options_.clear_j
          ? fmt::format(
                "{}: its motors push the wrong way along {}: {} N did {:.2g} mJ "
                "of work against it; no force is rendered",
                name_, "xyz"[axis_], options_.force_n, -1e3 * sum_j)
          : fmt::format("{}: {} N along {} moved nothing: hold the tool loosely in the "
                        "middle, away from its stops, and switch its power on",
                        name_, options_.force_n, "xyz"[axis_]));
}

SignWork test_signs(DeviceLink& link, const SignTestOptions& options,
                    const std::function<bool()>& stopped, Clock& clock) {
  SignTest test(link.name(), options);
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d position_m;
  try {
    for (;;) {
      if (stopped && stopped()) {
        throw Interrupted();
      }
      const LinkStatus status = link.transact(force_n, position_m);
      if (status == LinkStatus::kLost) {
        throw DeviceError(fmt::format("{}: {}", link.name(), link.failure()));
      }
      if (test.passed()) {
        return test.work_j();
      }
      force_n = test.next(
          status == LinkStatus::kOk ? std::optional(position_m) : std::nullopt,
          link.sent_n(), clock.now_ns());
    }
  } catch (...) {
    static_cast<void>(link.transact(Eigen::Vector3d::Zero(), position_m));
    throw;
  }
}

SignTestedLink::SignTestedLink(std::unique_ptr<DeviceLink> link,
                               const SignTestOptions& options,
                               std::function<void(const std::string&)> tell,
                               std::function<bool()> stopped)
    : link_(std::move(link)),
      options_(options),
      tell_(std::move(tell)),
      stopped_(std::move(stopped)) {}

void SignTestedLink::open() {
  link_->open();
  if (tell_) {
    tell_(
        fmt::format("{}: hold the tool loosely in the middle: it is pushed to and fro "
                    "with {} N, to "
                    "feel that its motors push the right way",
                    name(), options_.force_n));
  }
  MonotonicClock clock;
  try {
    static_cast<void>(test_signs(*link_, options_, stopped_, clock));
  } catch (...) {
    link_->close();
    throw;
  }
}

}  // namespace palpate
