#include "runtime/attach/probe.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kLeastStepM = 1e-8;  // float32 of a workspace's coordinates
constexpr double kRestS = 0.15;       // in which a tool at rest has not moved
constexpr double kRestMaxS = 5.0;
constexpr double kLetGoMaxS = 20.0;  // until it stands after a hand has left it
constexpr double kAxisS = 14.0;      // about, of an axis that is pushed
constexpr double kSpeedS = 0.01;     // over which a speed is taken
constexpr double kProgressS = 1.0;

constexpr const char* kNoMass =
    "its motion is not that of a mass with friction: somebody holds it, or it lies at "
    "a "
    "stop";

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

// What keeps one axis from being found, and no other.
struct AxisFailure {
  std::string why;
};

class Prober {
 public:
  Prober(DeviceLink& link, const ProbeOptions& options, const ProbeGuide& guide,
         Clock& clock)
      : link_(link), options_(options), guide_(guide), clock_(clock) {
    report_.device = link.name();
    report_.palpate = PALPATE_VERSION;
    report_.resolution_m = std::numeric_limits<double>::infinity();
    report_.by_hand = options.by_hand;
    left_s_ = probe_duration_s(options);
  }

  ProbeReport run() {
    look_at_wire();
    if (options_.by_hand) {
      be_moved();
      be_let_go();
    }
    origin_m_ = position_m_;
    for (const int axis : options_.axes) {
      report_.axis.push_back(probed(axis));
    }
    finish();
    return std::move(report_);
  }

  void let_go() noexcept {
    Eigen::Vector3d ignored;
    static_cast<void>(link_.transact(Eigen::Vector3d::Zero(), ignored));
  }

 private:
  static double seconds(std::int64_t duration_ns) {
    return static_cast<double>(duration_ns) / kNanosecondsPerSecond;
  }

  // The person holds it, or nobody does.
  void look_at_wire() {
    if (options_.by_hand) {
      await(
          "1 of 4: hold the tool in the middle of where it reaches, and keep it still");
    }
    const double wire_s = options_.by_hand ? options_.hold_s : options_.wire_s;
    begin_step(wire_s);
    begin_motion();
    std::int64_t answered = 0;
    while (motion_s() < wire_s) {
      answered += exchange(Eigen::Vector3d::Zero()) ? 1 : 0;
    }
    report_.free_rate_hz = static_cast<double>(answered) / motion_s();
    if (answered == 0) {
      throw DeviceError(
          fmt::format("{}: has no answer in {:g} s", link_.name(), wire_s));
    }
    report_.lowest_m = position_m_;
    report_.highest_m = position_m_;
  }

  void be_moved() {
    static constexpr std::array<std::array<const char*, 2>, 3> kWays{
        {{"to the right", "to the left"},
         {"up", "down"},
         {"towards you", "away from you"}}};
    static constexpr std::array<const char*, 2> kInPlane{"away from its base",
                                                         "towards its base"};
    for (std::size_t axis = 0; axis < (options_.planar ? 2U : 3U); ++axis) {
      for (std::size_t way = 0; way < 2; ++way) {
        say(fmt::format(
            "2 of 4: move it slowly {}, as far as it goes",
            options_.planar && axis == 1 ? kInPlane[way] : kWays[axis][way]));
        begin_step(options_.move_s);
        begin_motion();
        while (motion_s() < options_.move_s) {
          static_cast<void>(paced(Eigen::Vector3d::Zero()));
          report_.lowest_m = report_.lowest_m.cwiseMin(position_m_);
          report_.highest_m = report_.highest_m.cwiseMax(position_m_);
        }
      }
    }
  }

  void be_let_go() {
    await(
        "3 of 4: bring it back to the middle and let go: it must stand where it is "
        "left");
    if (!rests(kLetGoMaxS, 1.0)) {
      throw DeviceError(fmt::format(
          "{}: the tool does not come to rest: it must stand where it is left",
          link_.name()));
    }
  }

  ProbedAxis probed(int axis) {
    static constexpr std::array<const char*, 3> kNames{"x", "y", "z"};
    ProbedAxis found{.axis = axis};
    say(
        fmt::format("{}do not touch it: it is pushed to and fro along {}, with at most "
                    "{} N",
                    options_.by_hand ? "4 of 4: " : "",
                    kNames[static_cast<std::size_t>(axis)], options_.force_n));
    begin_step(kAxisS);
    free_ = true;
    axis_ = axis;
    try {
      find(found);
    } catch (const AxisFailure& failure) {
      let_go();
      found.failure = failure.why;
    }
    free_ = false;
    return found;
  }

  void find(ProbedAxis& found) {
    static_cast<void>(rise(1.0));  // learns the step
    static_cast<void>(rise(-1.0));
    std::vector<double> force_n;
    for (int i = 0; i < 2 * options_.rounds; ++i) {
      force_n.push_back(rise(i % 2 == 0 ? 1.0 : -1.0));
    }
    const Mean broken = mean_of(force_n);
    found.push = pushes(broken.mean);
    const PushFit fit = fit_pushes(found.push, options_.push_s);
    check_fit(fit, found);
    found.delay_s = std::max(0.0, fit.delay_s);
    found.delay_resolution_s =
        2.0 * fit.delay_sd + exchange_.percentile_ns(0.5) / kNanosecondsPerSecond;
    // While the force was on its way, the ramp had risen further.
    found.friction_n = broken.mean - options_.rise_n_per_s * found.delay_s;
    found.friction_sd_n = broken.sd;
    found.mass_kg = (options_.force_n - found.friction_n) / fit.acceleration_m_per_s2;
    found.damping_n_s_per_m = fit.decay_per_s * found.mass_kg;
    found.damping_sd_n_s_per_m = fit.decay_sd * found.mass_kg;
    if (!(found.mass_kg > 0.0) || !std::isfinite(found.damping_sd_n_s_per_m)) {
      throw AxisFailure{kNoMass};
    }
  }

  void check_fit(const PushFit& fit, const ProbedAxis& found) const {
    constexpr double kMisfit = 0.02;  // of the way, and a step
    double far_m = 0.0;
    for (const std::vector<ProbeSample>& push : found.push) {
      for (const ProbeSample& sample : push) {
        far_m = std::max(far_m, sample.way_m);
      }
    }
    if (!(fit.rms_m <= kMisfit * far_m + step())) {
      throw AxisFailure{kNoMass};
    }
  }

  // Force at which it begins to move.
  double rise(double sign) {
    await_rest();
    const double far_m = std::max(3e-4, 10.0 * step());
    std::vector<ProbeSample> samples;
    begin_motion();
    for (double force_n = 0.0; force_n < options_.force_n;) {
      force_n = options_.rise_n_per_s * motion_s();
      if (paced(along(sign * force_n))) {
        samples.push_back({begun_s_, way_m(sign)});
        if (samples.back().way_m > far_m) {
          break;
        }
      }
    }
    static_cast<void>(exchange(Eigen::Vector3d::Zero()));
    if (samples.empty() || samples.back().way_m <= far_m) {
      throw AxisFailure{fmt::format(
          "{} N moved nothing: let the tool stand free, away from its stops",
          options_.force_n)};
    }
    return options_.rise_n_per_s *
           begin_of_motion_s(samples, std::max(0.1 * far_m, 1.5 * step()));
  }

  // What the tool does while it is pushed.
  std::vector<ProbeSample> push(double sign, double friction_n, double brake) {
    await_rest();
    std::vector<ProbeSample> samples;
    begin_motion();
    gap_s_ = 0.0;
    while (motion_s() < options_.push_s && way_m(sign) < options_.push_m) {
      if (paced(along(sign * options_.force_n))) {
        samples.push_back({begun_s_, way_m(sign)});
      }
    }
    // As long against it, less what friction does.
    const double brake_s = brake * motion_s() * (options_.force_n - friction_n) /
                           (options_.force_n + friction_n);
    begin_motion();
    while (motion_s() < brake_s) {
      static_cast<void>(paced(along(-sign * options_.force_n)));
    }
    static_cast<void>(exchange(Eigen::Vector3d::Zero()));
    return samples;
  }

  // A machine that paused while the tool was pushed has not measured the tool: then
  // once more, as often again at most, and those with the shortest pauses count.
  std::vector<std::vector<ProbeSample>> pushes(double friction_n) {
    struct Pushed {
      double gap_s;
      std::vector<ProbeSample> samples;
    };
    const auto wanted = static_cast<std::size_t>(options_.pushes);
    std::vector<Pushed> all;
    std::size_t whole = 0;
    for (int i = 0; whole < wanted && all.size() < 2 * wanted; ++i) {
      // Braked for longer and longer, so that each begins elsewhere in a step of the
      // positions: alike, they would all be off alike.
      const double brake = 0.9 + 0.2 * (i % options_.pushes) / options_.pushes;
      auto samples = push(i % 2 == 0 ? 1.0 : -1.0, friction_n, brake);
      whole += gap_s_ <= longest_gap_s() ? 1 : 0;
      all.push_back({gap_s_, std::move(samples)});
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Pushed& one, const Pushed& other) {
                       return one.gap_s < other.gap_s;
                     });
    std::vector<std::vector<ProbeSample>> best;
    for (std::size_t i = 0; i < wanted; ++i) {
      best.push_back(std::move(all[i].samples));
    }
    return best;
  }

  [[nodiscard]] double longest_gap_s() const {
    constexpr double kExchanges = 3.0;
    return kExchanges * std::max(1.0 / options_.rate_hz,
                                 exchange_.percentile_ns(0.5) / kNanosecondsPerSecond);
  }

  void await_rest() {
    if (!rests(kRestMaxS, kRestS)) {
      throw AxisFailure{
          "the tool does not come to rest: it must stand where it is left"};
    }
  }

  // Whether it stands for so long within a time.
  bool rests(double within_s, double for_s) {
    begin_motion();
    double stood_since_s = 0.0;
    while (motion_s() - stood_since_s < for_s) {
      const Eigen::Vector3d before_m = position_m_;
      static_cast<void>(paced(Eigen::Vector3d::Zero()));
      if ((position_m_ - before_m).norm() > 1.5 * step()) {
        stood_since_s = motion_s();
      }
      if (motion_s() > within_s) {
        return false;
      }
    }
    return true;
  }

  // Planned to take so long, after which the next one's time is left.
  void begin_step(double planned_s) {
    step_ns_ = clock_.now_ns();
    step_s_ = planned_s;
    left_s_ -= planned_s;
  }

  // Least step so far; of a device that never moved yet: none.
  [[nodiscard]] double step() const {
    return std::isfinite(report_.resolution_m) ? report_.resolution_m : 0.0;
  }

  [[nodiscard]] Eigen::Vector3d along(double force_n) const {
    return std::clamp(force_n, -options_.force_n, options_.force_n) *
           Eigen::Vector3d::Unit(axis_);
  }

  void begin_motion() {
    begin_ns_ = clock_.now_ns();
    begun_s_ = 0.0;
    next_ns_ = begin_ns_;
    from_m_ = position_m_;
  }
  [[nodiscard]] double motion_s() { return seconds(clock_.now_ns() - begin_ns_); }
  [[nodiscard]] double way_m(double sign) const {
    return sign * (position_m_ - from_m_)[axis_];
  }

  // At the wanted rate.
  bool paced(const Eigen::Vector3d& force_n) {
    clock_.sleep_until_ns(next_ns_);
    next_ns_ += std::llround(kNanosecondsPerSecond / options_.rate_hz);
    const double before_s = begun_s_;
    begun_s_ = motion_s();
    const bool answered = exchange(force_n);
    gap_s_ = std::max({gap_s_, begun_s_ - before_s, motion_s() - begun_s_});
    return answered;
  }

  bool exchange(const Eigen::Vector3d& force_n) {
    if (guide_.stopped && guide_.stopped()) {
      throw Interrupted();
    }
    show_progress();
    Eigen::Vector3d position_m;
    const std::int64_t start_ns = clock_.now_ns();
    const LinkStatus status = link_.transact(force_n, position_m);
    exchange_.add(clock_.now_ns() - start_ns);
    ++report_.exchanges;
    report_.force_max_n = std::max(report_.force_max_n, force_n.norm());
    if (status == LinkStatus::kLost) {
      throw DeviceError(fmt::format("{}: {}", link_.name(), link_.failure()));
    }
    if (status == LinkStatus::kMissed) {
      ++report_.missed;
      return false;
    }
    if (report_.exchanges > report_.missed + 1) {
      learn_step(position_m - position_m_);
    }
    position_m_ = position_m;
    if (free_) {
      stop_a_runaway(start_ns);
    }
    return true;
  }

  // Of encoders on legs a count moves the tool aslant: its length is what counts.
  void learn_step(const Eigen::Vector3d& moved_m) {
    if (moved_m.norm() > kLeastStepM) {
      report_.resolution_m = std::min(report_.resolution_m, moved_m.norm());
    }
  }

  void stop_a_runaway(std::int64_t now_ns) {
    const double far_m = (position_m_ - origin_m_).norm();
    if (far_m > options_.runaway_m) {
      throw DeviceError(fmt::format("{}: the tool ran away by {:.3g} mm and was let go",
                                    link_.name(), 1e3 * far_m));
    }
    const double dt_s = seconds(now_ns - speed_ns_);
    if (dt_s < kSpeedS) {
      return;
    }
    const double speed_m_per_s = (position_m_ - speed_m_).norm() / dt_s;
    if (dt_s < 2.0 * kSpeedS && speed_m_per_s > options_.runaway_m_per_s) {
      throw DeviceError(
          fmt::format("{}: the tool ran away at {:.3g} m/s and was let go",
                      link_.name(), speed_m_per_s));
    }
    speed_ns_ = now_ns;
    speed_m_ = position_m_;
  }

  void say(const std::string& text) const {
    if (guide_.say) {
      guide_.say(text);
    }
  }

  void await(const std::string& text) const {
    if (guide_.await) {
      guide_.await(text);
    }
  }

  void show_progress() {
    const std::int64_t now_ns = clock_.now_ns();
    if (guide_.progress && now_ns >= told_ns_) {
      told_ns_ = now_ns + std::llround(kProgressS * kNanosecondsPerSecond);
      guide_.progress(left_s_ + std::max(0.0, step_s_ - seconds(now_ns - step_ns_)));
    }
  }

  void finish() {
    if (std::all_of(report_.axis.begin(), report_.axis.end(),
                    [](const ProbedAxis& axis) {
                      return !axis.failure.empty();
                    })) {
      throw DeviceError(fmt::format("{}: {}", link_.name(),
                                    report_.axis.empty()
                                        ? "no axis to push along"
                                        : report_.axis.front().failure));
    }
    report_.push_n = options_.force_n;
    report_.exchange_p50_s = exchange_.percentile_ns(0.5) / kNanosecondsPerSecond;
    report_.exchange_p99_s = exchange_.percentile_ns(0.99) / kNanosecondsPerSecond;
    report_.exchange_max_s = exchange_.max_ns() / kNanosecondsPerSecond;
  }

  DeviceLink& link_;
  const ProbeOptions& options_;
  const ProbeGuide& guide_;
  Clock& clock_;
  ProbeReport report_;
  StepHistogram exchange_;
  int axis_ = 0;         // that is pushed along
  bool free_ = false;    // nobody holds it
  double left_s_ = 0.0;  // of the steps after this one
  double step_s_ = 0.0;
  std::int64_t step_ns_ = 0;
  double begun_s_ = 0.0;  // of the latest exchange, since the motion began
  double gap_s_ = 0.0;    // longest between two exchanges, or of one, of a push
  std::int64_t begin_ns_ = 0;
  std::int64_t next_ns_ = 0;
  std::int64_t told_ns_ = 0;
  std::int64_t speed_ns_ = 0;
  Eigen::Vector3d position_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d from_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d speed_m_ = Eigen::Vector3d::Zero();
};

}  // namespace

double probe_duration_s(const ProbeOptions& options) {
  const double hand_s = options.hold_s + (options.planar ? 4.0 : 6.0) * options.move_s;
  return (options.by_hand ? hand_s : options.wire_s) +
         kAxisS * static_cast<double>(options.axes.size());
}

ProbeReport probe(DeviceLink& link, const ProbeOptions& options,
                  const ProbeGuide& guide, Clock& clock) {
  if (!(options.force_n > 0.0 && options.force_n <= kProbeForceMaxN)) {
    throw InputError(fmt::format("a device is probed with {} N, must lie in (0, {}]",
                                 options.force_n, kProbeForceMaxN));
  }
  Prober prober(link, options, guide, clock);
  try {
    return prober.run();
  } catch (...) {
    prober.let_go();
    throw;
  }
}

}  // namespace palpate
