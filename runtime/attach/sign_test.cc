#include "runtime/attach/sign_test.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kWatchS = 0.01;  // over which a speed is measured

// One exchange after the other, with a watch on where the tool goes.
class Pusher {
 public:
  Pusher(DeviceLink& link, const SignTestOptions& options,
         const std::function<bool()>& stopped, Clock& clock)
      : link_(link), options_(options), stopped_(stopped), clock_(clock) {}

  // W of two periods along an axis.
  double push_along(Eigen::Index axis) {
    begun_ = false;
    double work_j = 0.0;
    const std::int64_t begin_ns = clock_.now_ns();
    Eigen::Vector3d held = Eigen::Vector3d::Zero();
    std::optional<Eigen::Vector3d> before;
    for (double now_s = 0.0; now_s < 2.0 * options_.period_s;) {
      const double phase = 2.0 * std::numbers::pi * now_s / options_.period_s;
      const double sign = now_s < options_.period_s ? 1.0 : -1.0;
      Eigen::Vector3d force = Eigen::Vector3d::Zero();
      force[axis] = sign * options_.force_n * std::sin(phase);
      if (const auto position = exchange(force)) {
        if (before) {
          work_j += held.dot(*position - *before);
        }
        before = position;
        held = force;
      }
      now_s = seconds_in(clock_.now_ns() - begin_ns);
    }
    rest();
    return work_j;
  }

  void rest() {
    Eigen::Vector3d ignored;
    static_cast<void>(link_.transact(Eigen::Vector3d::Zero(), ignored));
  }

 private:
  std::optional<Eigen::Vector3d> exchange(const Eigen::Vector3d& force_n) {
    if (stopped_ && stopped_()) {
      rest();
      throw Interrupted();
    }
    Eigen::Vector3d position_m;
    const LinkStatus status = link_.transact(force_n, position_m);
    if (status == LinkStatus::kLost) {
      throw DeviceError(fmt::format("{}: {}", link_.name(), link_.failure()));
    }
    if (status != LinkStatus::kOk) {
      return std::nullopt;
    }
    watch(position_m);
    return position_m;
  }

  void watch(const Eigen::Vector3d& position_m) {
    const double now_s = seconds_in(clock_.now_ns());
    if (!begun_) {
      begun_ = true;
      begin_ = position_m;
      mark_ = position_m;
      mark_s_ = now_s;
    }
    bool ran = (position_m - begin_).norm() > options_.runaway_m;
    if (now_s - mark_s_ > kWatchS) {
      const double speed = (position_m - mark_).norm() / (now_s - mark_s_);
      ran = ran || speed > options_.runaway_m_per_s;
      mark_ = position_m;
      mark_s_ = now_s;
    }
    if (ran) {
      rest();
      throw DeviceError(fmt::format(
          "{}: the tool ran away by {:.3g} mm under {} N: hold it loosely in the "
          "middle and try again; if it runs again, its motors push the wrong way",
          link_.name(), 1e3 * (position_m - begin_).norm(), options_.force_n));
    }
  }

  DeviceLink& link_;
  const SignTestOptions& options_;
  const std::function<bool()>& stopped_;
  Clock& clock_;
  bool begun_ = false;
  Eigen::Vector3d begin_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d mark_ = Eigen::Vector3d::Zero();
  double mark_s_ = 0.0;
};

}  // namespace

SignWork test_signs(DeviceLink& link, const SignTestOptions& options,
                    const std::function<bool()>& stopped, Clock& clock) {
  Pusher pusher(link, options, stopped, clock);
  SignWork work_j{};
  for (int axis = 0; axis < options.axes; ++axis) {
    double& sum_j = work_j[static_cast<std::size_t>(axis)];
    for (int round = 0; round < options.rounds; ++round) {
      // W > clear_j: the motors push as they are asked to. Below -clear_j they push
      // against it. Between, the next round adds to the sum.
      sum_j += pusher.push_along(axis);
      if (sum_j > options.clear_j) {
        break;
      }
    }
    if (sum_j > options.clear_j) {
      continue;
    }
    throw DeviceError(
        sum_j < -options.clear_j
            ? fmt::format(
                  "{}: its motors push the wrong way along {}: {} N did {:.2g} mJ of "
                  "work against it; no force is rendered",
                  link.name(), "xyz"[axis], options.force_n, -1e3 * sum_j)
            : fmt::format(
                  "{}: {} N along {} moved nothing: hold the tool loosely in the "
                  "middle, away from its stops, and switch its power on",
                  link.name(), options.force_n, "xyz"[axis]));
  }
  return work_j;
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
