#include "runtime/attach/probe.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/attach/probe_wire.h"

namespace palpate {
namespace {

constexpr double kRestS = 0.15;  // in which a tool at rest has not moved
constexpr double kRestMaxS = 5.0;
constexpr double kLetGoMaxS = 20.0;  // until it stands after a hand has left it
constexpr double kAxisS = 14.0;      // about, of an axis that is pushed

constexpr const char* kNoMass =
    "its motion is not that of a mass with friction: somebody holds it, or it lies at "
    "a stop";

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
      : options_(options),
        guide_(guide),
        wire_(link, options, guide, clock, probe_duration_s(options)) {
    report_.device = link.name();
    report_.palpate = PALPATE_VERSION;
    report_.by_hand = options.by_hand;
  }

  ProbeReport run() {
    look_at_wire();
    if (options_.by_hand) {
      be_moved();
      be_let_go();
    }
    for (const int axis : options_.axes) {
      report_.axis.push_back(probed(axis));
    }
    finish();
    return std::move(report_);
  }

  void let_go() noexcept { wire_.let_go(); }

 private:
  // The person holds it, or nobody does.
  void look_at_wire() {
    if (options_.by_hand) {
      await(
          "1 of 4: hold the tool in the middle of where it reaches, and keep it still");
    }
    const double wire_s = options_.by_hand ? options_.hold_s : options_.wire_s;
    wire_.begin_step(wire_s);
    wire_.begin_motion();
    std::int64_t answered = 0;
    while (wire_.motion_s() < wire_s) {
      answered += wire_.exchange(0.0) ? 1 : 0;
    }
    report_.free_rate_hz = static_cast<double>(answered) / wire_.motion_s();
    if (answered == 0) {
      throw DeviceError(
          fmt::format("{}: has no answer in {:g} s", report_.device, wire_s));
    }
    report_.lowest_m = wire_.position_m();
    report_.highest_m = wire_.position_m();
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
        wire_.begin_step(options_.move_s);
        wire_.begin_motion();
        while (wire_.motion_s() < options_.move_s) {
          static_cast<void>(wire_.paced(0.0));
          report_.lowest_m = report_.lowest_m.cwiseMin(wire_.position_m());
          report_.highest_m = report_.highest_m.cwiseMax(wire_.position_m());
        }
      }
    }
  }

  void be_let_go() {
    await(
        "3 of 4: bring it back to the middle and let go: it must stand where it is "
        "left");
    if (!wire_.rests(kLetGoMaxS, 1.0)) {
      throw DeviceError(fmt::format(
          "{}: the tool does not come to rest: it must stand where it is left",
          report_.device));
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
    wire_.begin_step(kAxisS);
    wire_.begin_pushing(axis);
    try {
      find(found);
    } catch (const AxisFailure& failure) {
      wire_.let_go();
      found.failure = failure.why;
    }
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
    found.delay_resolution_s = 2.0 * fit.delay_sd + wire_.exchange_s(0.5);
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
    if (!(fit.rms_m <= kMisfit * far_m + wire_.step_m())) {
      throw AxisFailure{kNoMass};
    }
  }

  // Force at which it begins to move.
  double rise(double sign) {
    await_rest();
    const double far_m = std::max(3e-4, 10.0 * wire_.step_m());
    std::vector<ProbeSample> samples;
    wire_.begin_motion();
    for (double force_n = 0.0; force_n < options_.force_n;) {
      force_n = options_.rise_n_per_s * wire_.motion_s();
      if (wire_.paced(sign * force_n)) {
        samples.push_back({wire_.begun_s(), wire_.way_m(sign)});
        if (samples.back().way_m > far_m) {
          break;
        }
      }
    }
    static_cast<void>(wire_.exchange(0.0));
    if (samples.empty() || samples.back().way_m <= far_m) {
      throw AxisFailure{fmt::format(
          "{} N moved nothing: let the tool stand free, away from its stops",
          options_.force_n)};
    }
    return options_.rise_n_per_s *
           begin_of_motion_s(samples, std::max(0.1 * far_m, 1.5 * wire_.step_m()));
  }

  struct Pushed {
    double gap_s = 0.0;  // longest pause
    std::vector<ProbeSample> samples{};
  };

  // What the tool does while it is pushed.
  Pushed push(double sign, double friction_n, double brake) {
    await_rest();
    Pushed pushed;
    wire_.begin_motion();
    while (wire_.motion_s() < options_.push_s && wire_.way_m(sign) < options_.push_m) {
      if (wire_.paced(sign * options_.force_n)) {
        pushed.samples.push_back({wire_.begun_s(), wire_.way_m(sign)});
      }
    }
    pushed.gap_s = wire_.gap_s();
    // As long against it, less what friction does.
    const double brake_s = brake * wire_.motion_s() * (options_.force_n - friction_n) /
                           (options_.force_n + friction_n);
    wire_.begin_motion();
    while (wire_.motion_s() < brake_s) {
      static_cast<void>(wire_.paced(-sign * options_.force_n));
    }
    static_cast<void>(wire_.exchange(0.0));
    return pushed;
  }

  // A machine that paused while the tool was pushed has not measured the tool: then
  // once more, as often again at most, and those with the shortest pauses count.
  std::vector<std::vector<ProbeSample>> pushes(double friction_n) {
    const auto wanted = static_cast<std::size_t>(options_.pushes);
    std::vector<Pushed> all;
    std::size_t whole = 0;
    for (int i = 0; whole < wanted && all.size() < 2 * wanted; ++i) {
      // Braked for longer and longer, so that each begins elsewhere in a step of the
      // positions: alike, they would all be off alike.
      const double brake = 0.9 + 0.2 * (i % options_.pushes) / options_.pushes;
      all.push_back(push(i % 2 == 0 ? 1.0 : -1.0, friction_n, brake));
      whole += all.back().gap_s <= longest_gap_s() ? 1 : 0;
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
    return kExchanges * std::max(1.0 / options_.rate_hz, wire_.exchange_s(0.5));
  }

  void await_rest() {
    if (!wire_.rests(kRestMaxS, kRestS)) {
      throw AxisFailure{
          "the tool does not come to rest: it must stand where it is left"};
    }
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

  void finish() {
    if (std::all_of(report_.axis.begin(), report_.axis.end(),
                    [](const ProbedAxis& axis) {
                      return !axis.failure.empty();
                    })) {
      throw DeviceError(fmt::format("{}: {}", report_.device,
                                    report_.axis.empty()
                                        ? "no axis to push along"
                                        : report_.axis.front().failure));
    }
    wire_.report(report_);
    report_.push_n = options_.force_n;
  }

  const ProbeOptions& options_;
  const ProbeGuide& guide_;
  ProbeReport report_;
  ProbeWire wire_;
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
