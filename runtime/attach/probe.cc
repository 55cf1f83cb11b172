#include "runtime/attach/probe.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

constexpr double kLeastStepM = 1e-8;  // float32 of a workspace's coordinates
constexpr double kRestS = 0.15;       // in which a tool at rest has not moved
constexpr double kRestMaxS = 5.0;

struct Sample {
  double time_s = 0.0;  // when the exchange began, from the begin of a motion
  double way_m = 0.0;   // along the push, from there
};

struct Mean {
  double mean = 0.0;
  double sd = 0.0;  // of one
};

Mean mean_of(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  Mean result;
  for (const double value : values) {
    result.mean += value / n;
  }
  for (const double value : values) {
    result.sd += (value - result.mean) * (value - result.mean) / std::max(n - 1.0, 1.0);
  }
  result.sd = std::sqrt(result.sd);
  return result;
}

struct Motion {
  double acceleration_m_per_s2 = 0.0;
  double delay_s = 0.0;
};

// The delay by trial, all else linear; where each push began is averaged away.
Motion fitted(const std::vector<std::vector<Sample>>& pushes, double push_s) {
  constexpr double kTrialS = 5e-5;
  Motion best;
  double least = std::numeric_limits<double>::infinity();
  for (double delay_s = 0.0; delay_s < 0.5 * push_s; delay_s += kTrialS) {
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();  // of t^2 / 2, t^3 and the way
    for (const std::vector<Sample>& samples : pushes) {
      Eigen::MatrixX3d rows(static_cast<Eigen::Index>(samples.size()), 3);
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const double t = std::max(samples[i].time_s - delay_s, 0.0);
        rows.row(static_cast<Eigen::Index>(i)) << 0.5 * t * t, t * t * t,
            samples[i].way_m;
      }
      rows.rowwise() -= rows.colwise().mean().eval();
      products += rows.transpose() * rows;
    }
    const Eigen::Vector2d found =
        products.topLeftCorner<2, 2>().ldlt().solve(products.topRightCorner<2, 1>());
    const double error = products(2, 2) - found.dot(products.topRightCorner<2, 1>());
    if (error < least) {
      least = error;
      best = {.acceleration_m_per_s2 = found[0], .delay_s = delay_s};
    }
  }
  return best;
}

class Prober {
 public:
  Prober(DeviceLink& link, const ProbeOptions& options,
         const std::function<bool()>& stopped, ProbeReport& report)
      : link_(link), options_(options), stopped_(stopped), report_(report) {
    report_.resolution_m = std::numeric_limits<double>::infinity();
  }

  void look_at_wire() {
    const std::int64_t begin_ns = clock_.now_ns();
    std::int64_t answered = 0;
    double time_s = 0.0;
    while (time_s < options_.wire_s) {
      answered += exchange(0.0) ? 1 : 0;
      time_s = seconds(clock_.now_ns() - begin_ns);
    }
    report_.free_rate_hz = static_cast<double>(answered) / time_s;
    origin_m_ = position_m_;
  }

  // Force at which it begins to move.
  double rise(double sign) {
    rest();
    const double far_m = std::max(3e-4, 10.0 * step());
    std::vector<Sample> samples;
    begin_motion();
    for (double force_n = 0.0; force_n < options_.force_n;) {
      force_n = options_.rise_n_per_s * motion_s();
      if (paced(sign * force_n)) {
        samples.push_back({begun_s_, way_m(sign)});
        if (samples.back().way_m > far_m) {
          break;
        }
      }
    }
    static_cast<void>(exchange(0.0));
    if (samples.empty() || samples.back().way_m <= far_m) {
      throw DeviceError(fmt::format(
          "{}: {} N moved nothing: let the tool stand free, away from its stops",
          link_.name(), options_.force_n));
    }
    return options_.rise_n_per_s * zero_of_cube_root(samples, far_m);
  }

  // What the tool does while it is pushed.
  std::vector<Sample> push(double sign, double friction_n) {
    rest();
    std::vector<Sample> samples;
    begin_motion();
    while (motion_s() < options_.push_s) {
      if (paced(sign * options_.force_n)) {
        samples.push_back({begun_s_, way_m(sign)});
      }
    }
    // As long against it, less what friction does.
    const double brake_s = options_.push_s * (options_.force_n - friction_n) /
                           (options_.force_n + friction_n);
    begin_motion();
    while (motion_s() < brake_s) {
      static_cast<void>(paced(-sign * options_.force_n));
    }
    static_cast<void>(exchange(0.0));
    return samples;
  }

 private:
  static double seconds(std::int64_t duration_ns) {
    return static_cast<double>(duration_ns) / kNanosecondsPerSecond;
  }

  // Least step so far; of a device that never moved yet: none.
  [[nodiscard]] double step() const {
    return std::isfinite(report_.resolution_m) ? report_.resolution_m : 0.0;
  }

  void begin_motion() {
    begin_ns_ = clock_.now_ns();
    next_ns_ = begin_ns_;
    from_m_ = position_m_;
  }
  [[nodiscard]] double motion_s() { return seconds(clock_.now_ns() - begin_ns_); }
  [[nodiscard]] double way_m(double sign) const {
    return sign * (position_m_ - from_m_)[options_.axis];
  }

  // At the wanted rate.
  bool paced(double force_n) {
    clock_.sleep_until_ns(next_ns_);
    next_ns_ += std::llround(kNanosecondsPerSecond / options_.rate_hz);
    begun_s_ = motion_s();
    return exchange(force_n);
  }

  bool exchange(double force_n) {
    if (stopped_ && stopped_()) {
      let_go();
      throw Interrupted();
    }
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    force[options_.axis] = force_n;
    Eigen::Vector3d position_m;
    const std::int64_t start_ns = clock_.now_ns();
    const LinkStatus status = link_.transact(force, position_m);
    report_.exchange.add(clock_.now_ns() - start_ns);
    ++report_.exchanges;
    if (status == LinkStatus::kLost) {
      throw DeviceError(fmt::format("{}: {}", link_.name(), link_.failure()));
    }
    if (status == LinkStatus::kMissed) {
      ++report_.missed;
      return false;
    }
    const double step_m = std::abs((position_m - position_m_)[options_.axis]);
    if (report_.exchanges > 1 && step_m > kLeastStepM) {
      report_.resolution_m = std::min(report_.resolution_m, step_m);
    }
    position_m_ = position_m;
    if (origin_m_.allFinite() && (position_m - origin_m_).norm() > options_.runaway_m) {
      let_go();
      throw DeviceError(fmt::format("{}: the tool ran away by {:.3g} mm", link_.name(),
                                    1e3 * (position_m - origin_m_).norm()));
    }
    return true;
  }

  void let_go() {
    Eigen::Vector3d ignored;
    static_cast<void>(link_.transact(Eigen::Vector3d::Zero(), ignored));
  }

  void rest() {
    begin_motion();
    double stood_since_s = 0.0;
    while (motion_s() - stood_since_s < kRestS) {
      const Eigen::Vector3d before_m = position_m_;
      static_cast<void>(paced(0.0));
      if ((position_m_ - before_m).norm() > 1.5 * step()) {
        stood_since_s = motion_s();
      }
      if (motion_s() > kRestMaxS) {
        throw DeviceError(fmt::format(
            "{}: the tool does not come to rest: it must stand where it is left",
            link_.name()));
      }
    }
  }

  // Line through the cube roots, against time; where it is zero.
  double zero_of_cube_root(const std::vector<Sample>& samples, double far_m) const {
    double n = 0.0;
    double t = 0.0;
    double y = 0.0;
    double tt = 0.0;
    double ty = 0.0;
    for (const Sample& sample : samples) {
      if (sample.way_m > std::max(0.1 * far_m, 1.5 * step())) {
        const double root = std::cbrt(sample.way_m);
        n += 1.0;
        t += sample.time_s;
        y += root;
        tt += sample.time_s * sample.time_s;
        ty += sample.time_s * root;
      }
    }
    const double slope = (n * ty - t * y) / (n * tt - t * t);
    return std::isfinite(slope) && slope > 0.0 ? (t - y / slope) / n
                                               : samples.back().time_s;
  }

  DeviceLink& link_;
  const ProbeOptions& options_;
  const std::function<bool()>& stopped_;
  ProbeReport& report_;
  MonotonicClock clock_;
  Eigen::Vector3d position_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d origin_m_ =
      Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Vector3d from_m_ = Eigen::Vector3d::Zero();
  double begun_s_ = 0.0;
  std::int64_t begin_ns_ = 0;
  std::int64_t next_ns_ = 0;
};

}  // namespace

ProbeReport probe(DeviceLink& link, const ProbeOptions& options,
                  const std::function<bool()>& stopped) {
  ProbeReport report;
  report.device = link.name();
  Prober prober(link, options, stopped, report);
  prober.look_at_wire();
  static_cast<void>(prober.rise(1.0));  // learns the step
  static_cast<void>(prober.rise(-1.0));
  std::vector<double> friction;
  for (int i = 0; i < 2 * options.rounds; ++i) {
    friction.push_back(prober.rise(i % 2 == 0 ? 1.0 : -1.0));
  }
  report.friction_n = mean_of(friction).mean;
  report.friction_sd_n = mean_of(friction).sd;
  std::vector<std::vector<Sample>> pushes;
  for (int i = 0; i < options.pushes; ++i) {
    pushes.push_back(prober.push(i % 2 == 0 ? 1.0 : -1.0, report.friction_n));
  }
  const Motion motion = fitted(pushes, options.push_s);
  report.mass_kg = (options.force_n - report.friction_n) / motion.acceleration_m_per_s2;
  report.delay_s = motion.delay_s;
  return report;
}

std::string probe_text(const ProbeReport& r) {
  return fmt::format(
      "{}: {:.5g} exchanges a second, {} of {} missed, p50 {:.3f} ms, p99 {:.3f} ms\n"
      "step of positions   {:.3g} mm\n"
      "dry friction        {:.3g} N, +- {:.1g}\n"
      "mass                {:.3g} kg\n"
      "delay of forces     {:.3g} ms\n",
      r.device, r.free_rate_hz, r.missed, r.exchanges,
      r.exchange.percentile_ns(0.5) / 1e6, r.exchange.percentile_ns(0.99) / 1e6,
      1e3 * r.resolution_m, r.friction_n, r.friction_sd_n, r.mass_kg, 1e3 * r.delay_s);
}

std::string probe_json(const ProbeReport& r) {
  const nlohmann::ordered_json json = {{"device", r.device},
                                       {"palpate", PALPATE_VERSION},
                                       {"exchanges", r.exchanges},
                                       {"missed", r.missed},
                                       {"rate_hz", r.free_rate_hz},
                                       {"p50_ns", r.exchange.percentile_ns(0.5)},
                                       {"p99_ns", r.exchange.percentile_ns(0.99)},
                                       {"max_ns", r.exchange.max_ns()},
                                       {"resolution_m", r.resolution_m},
                                       {"friction_n", r.friction_n},
                                       {"friction_sd_n", r.friction_sd_n},
                                       {"mass_kg", r.mass_kg},
                                       {"delay_s", r.delay_s}};
  return json.dump(2) + "\n";
}

}  // namespace palpate
