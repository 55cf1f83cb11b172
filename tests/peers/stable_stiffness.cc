#include "tests/peers/stable_stiffness.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/bench/axis_device.h"

namespace palpate::peers {
namespace {

constexpr double kDepthShare = 0.6;    // of the largest, where the device leans
constexpr double kSettleTicks = 400;   // until a renderer that moves is at rest
constexpr double kProbeShare = 0.02;   // of the largest depth, to each side
constexpr double kHandDamping = 50.0;  // [N s/m] while the device settles
constexpr double kSettleS = 2.0;
constexpr double kKick = 0.005;  // [m/s]
constexpr double kQuarterS = 1.0;
constexpr double kStillM = 1e-7;  // a range below this is at rest
constexpr double kFrom = 10.0;    // [N/m] first stiffness
constexpr double kRaise = 1.2;
constexpr double kMost = 20000.0;
constexpr double kTolerance = 0.01;

// The renderer along the site's normal.
class AxisOfSite {
 public:
  AxisOfSite(const Renderer& renderer, const std::string& variant,
             const PeerScene& scene, const std::filesystem::path& own, double tick_s)
      : scene_(scene), tool_(renderer, variant, scene.folder, own, tick_s) {}

  double force_n(double depth_m) {
    return tool_.tick(centre_at(scene_.site, scene_.radius_m, depth_m))
        .dot(scene_.site.outward);
  }

  double force_at_rest_n(double depth_m) {
    double f = 0.0;
    for (int i = 0; i < kSettleTicks; ++i) {
      f = force_n(depth_m);
    }
    return f;
  }

 private:
  const PeerScene& scene_;
  OpenTool tool_;
};

struct Rest {
  double depth_m;
  double force_n;
  double stiffness_n_per_m;
};

Rest at_rest(AxisOfSite&& axis, const PeerScene& scene) {
  const double depth = kDepthShare * scene.depth_max_m;
  const double h = kProbeShare * scene.depth_max_m;
  // From the air inwards, as a tool comes.
  for (double d = -h; d < depth; d += 0.1 * h) {
    (void)axis.force_n(d);
  }
  const double low = axis.force_at_rest_n(depth - h);
  const double middle = axis.force_at_rest_n(depth);
  const double high = axis.force_at_rest_n(depth + h);
  return {depth, middle, (high - low) / (2.0 * h)};
}

class Leaning {
 public:
  Leaning(AxisOfSite&& axis, const LeaningDevice& d, double gain, double preload_n)
      : axis_(std::move(axis)),
        model_(d.device),
        gain_(gain),
        preload_n_(preload_n),
        tick_s_(1.0 / d.fast_hz),
        device_(d.device.mass, tick_s_),
        late_(static_cast<std::size_t>(std::ceil(d.device.delay_s / tick_s_ - 1e-9)),
              0.0) {}

  // @param stiffness_n_per_m of the scaled renderer at rest.
  bool kick_dies_out(double stiffness_n_per_m) {
    VirtualDeviceOptions held = model_.mass;
    held.damping_n_s_per_m += kHandDamping;
    device_ = VirtualDevice(held, tick_s_);
    (void)range_m(kSettleS);
    const double x = device_.position_m();
    device_ = VirtualDevice(model_.mass, tick_s_);
    device_.set_position_m(x);
    device_.kick(kKick);
    const double first = range_m(kQuarterS);
    (void)range_m(2.0 * kQuarterS);
    const double last = range_m(kQuarterS);
    // A measured position that is one of two neighbours is at rest. A limit cycle may
    // shrink a little by chance, but is wider than the kick's own swing.
    const double swing =
        2.0 * kKick * std::sqrt(model_.mass.mass_kg / stiffness_n_per_m);
    return last <= std::max(kStillM, 2.0 * model_.resolution_m) ||
           (last < first && last < swing);
  }

 private:
  double range_m(double seconds) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (long n = std::lround(seconds / tick_s_); n > 0; --n, ++count_) {
      const double x = device_.position_m();
      low = std::min(low, x);
      high = std::max(high, x);
      double force = gain_ * axis_.force_n(measured(x));
      if (!late_.empty()) {
        std::swap(force, late_[count_ % late_.size()]);
      }
      device_.step(preload_n_ - force);
    }
    return high - low;
  }

  [[nodiscard]] double measured(double x) const {
    const double q = model_.resolution_m;
    return q > 0.0 ? q * std::round(x / q) : x;
  }

  AxisOfSite axis_;
  const TradeDevice& model_;
  double gain_;
  double preload_n_;
  double tick_s_;
  VirtualDevice device_;
  std::vector<double> late_;
  std::size_t count_ = 0;
};

}  // namespace

std::vector<LeaningDevice> leaning_devices() {
  std::vector<LeaningDevice> all;
  for (const TradeDevice& device : trade_devices()) {
    all.push_back({device, device.delay_s > 0.0 ? 1000.0 : 2000.0});
  }
  return all;
}

StableStiffness largest_stable_stiffness(const Renderer& renderer,
                                         const std::string& variant,
                                         const PeerScene& scene,
                                         const std::filesystem::path& own,
                                         const LeaningDevice& device) {
  const auto opened = [&] {
    return AxisOfSite(renderer, variant, scene, own, 1.0 / device.fast_hz);
  };
  const Rest rest = at_rest(opened(), scene);
  StableStiffness result{.rest_n_per_m = rest.stiffness_n_per_m};
  if (!(rest.stiffness_n_per_m > 0.0)) {
    result.stiffness_n_per_m = std::numeric_limits<double>::quiet_NaN();
    return result;
  }
  const auto stable = [&](double stiffness_n_per_m) {
    const double gain = stiffness_n_per_m / rest.stiffness_n_per_m;
    return Leaning(opened(), device, gain, gain * rest.force_n)
        .kick_dies_out(stiffness_n_per_m);
  };
  double good = 0.0;
  double bad = kFrom;
  while (stable(bad)) {
    good = bad;
    bad *= kRaise;
    if (bad > kMost) {
      result.stiffness_n_per_m = good;
      result.at_end = true;
      return result;
    }
  }
  while (good > 0.0 && bad - good > kTolerance * good) {
    const double middle = 0.5 * (good + bad);
    (stable(middle) ? good : bad) = middle;
  }
  result.stiffness_n_per_m = good;
  return result;
}

}  // namespace palpate::peers
