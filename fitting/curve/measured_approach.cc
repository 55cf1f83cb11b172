#include "fitting/curve/measured_approach.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include <fmt/format.h>

#include "fitting/curve/segments.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

// m and N: squares of what is larger, or smaller, are no numbers.
constexpr double kLargestReading = 1e30, kSmallest = 1e-30;
constexpr double kHoldTolerance = 1e-3;  // [-] of the travel: a stage's position noise
constexpr std::size_t kHoldMin = 3;      // samples
constexpr double kRetractMin = 0.2;      // [-] of the travel: less is no loop
constexpr double kRiseInHold = 0.1;      // [-] of the forces' range
constexpr std::size_t kDense = 5000;     // samples of an approach
constexpr double kSlowingShare = 0.1;    // [-] of the travel
constexpr double kFallDeviations = 5.0;
constexpr double kSpikeDeviations = 8.0;
constexpr std::size_t kSpikeReach = 3;  // neighbours on each side
constexpr double kWorkDeviations = 5.0;

void check_measurement(const Measurement& measurement) {
  const auto& x = measurement.depth_m;
  const auto& f = measurement.force_n;
  if (x.size() != f.size() || x.size() < kSamplesMin) {
    throw InputError(
        fmt::format("measurement has {} displacements and {} forces, need as many of "
                    "both and at least {}",
                    x.size(), f.size(), kSamplesMin));
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(std::abs(x[i]) <= kLargestReading) || !(std::abs(f[i]) <= kLargestReading)) {
      throw InputError(
          fmt::format("sample {} is ({} m, {} N), must be finite and at most {:g}",
                      i + 1, x[i], f[i], kLargestReading));
    }
  }
  if (const double range = extent(f); range > 0.0 && range < kSmallest) {
    throw InputError(fmt::format(
        "the forces differ by {:g} N, need none or {:g} N: tell the force's unit",
        range, kSmallest));
  }
}

void turn(std::vector<double>& values) {
  std::transform(values.begin(), values.end(), values.begin(), std::negate<>());
}

// Work of the force over displacement [J], where the displacement exceeds `lower`;
// trapezoids, the one that crosses `lower` cut there.
double work_above(std::span<const double> x, std::span<const double> f, double lower) {
  double work = 0.0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    double x0 = x[i], x1 = x[i + 1], f0 = f[i], f1 = f[i + 1];
    if (std::max(x0, x1) <= lower) {
      continue;
    }
    const double slope = x1 == x0 ? 0.0 : (f1 - f0) / (x1 - x0);
    if (x0 < lower) {
      f0 += slope * (lower - x0);
      x0 = lower;
    } else if (x1 < lower) {
      f1 += slope * (lower - x1);
      x1 = lower;
    }
    work += 0.5 * (f0 + f1) * (x1 - x0);
  }
  return work;
}

// Press and release work over the displacements that both cover.
void close_loop(const Measurement& m, std::size_t end, Approach& approach) {
  const double travel = extent(m.depth_m);
  const double largest = *std::max_element(m.depth_m.begin(), m.depth_m.end());
  const std::span x(m.depth_m), f(m.force_n);
  const double back =
      *std::min_element(x.begin() + static_cast<std::ptrdiff_t>(end), x.end());
  if (largest - back < kRetractMin * travel) {
    return;
  }
  const auto peak = static_cast<std::size_t>(
      std::max_element(m.depth_m.begin(), m.depth_m.end()) - m.depth_m.begin());
  const double lower = std::max(m.depth_m.front(), back);
  approach.press_work_j = work_above(x.first(peak + 1), f.first(peak + 1), lower);
  approach.release_work_j = -work_above(x.subspan(peak), f.subspan(peak), lower);
  double squared_steps = 0.0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    squared_steps += (x[i + 1] - x[i]) * (x[i + 1] - x[i]);
  }
  // Work by the trapezoidal rule has noise sd sqrt(sum of squared steps).
  const double noise_work = approach.noise_sd_n * std::sqrt(squared_steps);
  if (approach.release_work_j - approach.press_work_j >
      kWorkDeviations * noise_work + 1e-9 * std::abs(approach.press_work_j)) {
    approach.flags.push_back(FitFlag::kNonPassiveLoop);
  }
}

// Turns the signs so that compression and its force are positive.
void turn_signs(Measurement& m, Approach& approach) {
  const auto [low, high] = std::minmax_element(m.depth_m.begin(), m.depth_m.end());
  if (m.depth_m.front() - *low > *high - m.depth_m.front()) {
    turn(m.depth_m);
    approach.flags.push_back(FitFlag::kDepthSignTurned);
  }
  const auto peak = std::max_element(m.depth_m.begin(), m.depth_m.end());
  const auto end = static_cast<std::size_t>(peak - m.depth_m.begin()) + 1;
  const std::size_t few = std::min<std::size_t>(5, end);
  const std::span f(m.force_n);
  const auto start = f.first(few);
  const auto deepest = f.subspan(end - few, few);
  const double rise =
      median({deepest.begin(), deepest.end()}) - median({start.begin(), start.end()});
  // What breaks may end below where it began, but has risen by more on the way; a tool
  // that first goes back is not on it.
  const auto back = std::min_element(m.depth_m.begin(), peak) - m.depth_m.begin();
  const std::vector<double> way =
      running_median(f.first(end).subspan(static_cast<std::size_t>(back)), kSpikeReach);
  const auto [least, most] = std::minmax_element(way.begin(), way.end());
  if (*most - way.front() < way.front() - *least &&
      rise < -5.0 * noise_standard_deviation(f)) {
    turn(m.force_n);
    approach.flags.push_back(FitFlag::kForceSignTurned);
  }
}

// Where the approach ends: first sample within the tolerance of the largest one.
std::size_t approach_end(const Measurement& m) {
  const double largest = *std::max_element(m.depth_m.begin(), m.depth_m.end());
  const double enough = largest - kHoldTolerance * extent(m.depth_m);
  const auto first = std::find_if(m.depth_m.begin(), m.depth_m.end(), [&](double x) {
    return x >= enough;
  });
  return static_cast<std::size_t>(first - m.depth_m.begin()) + 1;
}

// A machine slows down before it holds: where the force has already fallen from its
// peak in the last part of the travel, relaxation has taken over, and the hold begins
// at the peak.
std::size_t before_relaxation(const Measurement& m, std::size_t end, double noise_n) {
  const auto first = m.force_n.begin();
  const auto peak =
      std::max_element(first, first + static_cast<std::ptrdiff_t>(end)) - first;
  const auto at = static_cast<std::size_t>(peak);
  const double last = *std::max_element(m.depth_m.begin(), m.depth_m.end()) -
                      kSlowingShare * extent(m.depth_m);
  const bool held = end + kHoldMin <= m.depth_m.size() &&
                    std::abs(m.depth_m[end + kHoldMin - 1] - m.depth_m[end - 1]) <=
                        2.0 * kHoldTolerance * extent(m.depth_m);
  return held && m.depth_m[at] >= last &&
                 m.force_n[end - 1] < m.force_n[at] - kFallDeviations * noise_n
             ? at + 1
             : end;
}

// Over samples in a row, from the mean of the first tenth to that of the last.
double rise(std::span<const double> force_n) {
  const std::size_t few = std::max<std::size_t>(1, force_n.size() / 10);
  const auto mean = [&](std::span<const double> part) {
    return std::accumulate(part.begin(), part.end(), 0.0) /
           static_cast<double>(part.size());
  };
  return mean(force_n.last(few)) - mean(force_n.first(few));
}

void count_rest(const Measurement& m, std::size_t end, Approach& approach) {
  const double largest = *std::max_element(m.depth_m.begin(), m.depth_m.end());
  const double held = largest - 2.0 * kHoldTolerance * extent(m.depth_m);
  const std::size_t slowing = approach_end(m);  // between the force's peak and there
  for (std::size_t i = end; i < m.depth_m.size(); ++i) {
    ++(m.depth_m[i] >= held || i < slowing ? approach.hold_samples
                                           : approach.retract_samples);
  }
  if (approach.hold_samples >= kHoldMin) {
    approach.flags.push_back(FitFlag::kHoldCutOff);
    const auto held_n = std::span(m.force_n).subspan(end, approach.hold_samples);
    if (rise(held_n) > kRiseInHold * extent(m.force_n) &&
        rise(held_n) > kFallDeviations * approach.noise_sd_n) {
      approach.flags.push_back(FitFlag::kForceRisesInHold);
    }
  }
  if (approach.retract_samples > 0) {
    approach.flags.push_back(FitFlag::kRetractCutOff);
  }
}

// Whether the force falls while the tool stands still on its way, and goes on.
bool holds_on_its_way(const Measurement& m, std::size_t end, double noise_n) {
  const auto segments = find_segments(std::span(m.depth_m).first(end));
  for (std::size_t i = 0; i + 1 < segments.size(); ++i) {
    const auto [kind, begin, after] = segments[i];
    const auto force = std::span(m.force_n).subspan(begin, after - begin);
    if (kind == SegmentKind::kHold && rise(force) < -kFallDeviations * noise_n) {
      return true;
    }
  }
  return false;
}

// Means of neighbours where samples are far denser than any law needs.
void thin(Approach& approach) {
  const std::size_t together = approach.force_n.size() / kDense;
  if (together < 2) {
    return;
  }
  const std::size_t count = approach.force_n.size() / together;
  for (std::vector<double>* values : {&approach.displacement_m, &approach.force_n}) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto first = values->begin() + static_cast<std::ptrdiff_t>(i * together);
      const double sum =
          std::accumulate(first, first + static_cast<std::ptrdiff_t>(together), 0.0);
      (*values)[i] = sum / static_cast<double>(together);
    }
    values->resize(count);
  }
  approach.noise_sd_n = noise_standard_deviation(approach.force_n);
}

bool goes_back(std::span<const double> x, double tolerance) {
  double deepest = x.front();
  for (const double here : x) {
    if (here < deepest - tolerance) {
      return true;
    }
    deepest = std::max(deepest, here);
  }
  return false;
}

// A reading that stands out from all its neighbours by more than the limit and twice
// their own steps. The ends are left to the fit's robust loss: a peak there is no
// spike.
bool is_spike(std::span<const double> f, std::size_t i, double limit) {
  if (i < kSpikeReach || i + kSpikeReach >= f.size()) {
    return false;
  }
  double low = f[i - 1], high = low, before = f[i - kSpikeReach];
  for (std::size_t j = i - kSpikeReach; j <= i + kSpikeReach; ++j) {
    if (j != i) {
      low = std::min(low, f[j]);
      high = std::max(high, f[j]);
      limit = std::max(limit, 2.0 * std::abs(f[j] - before));
      before = f[j];
    }
  }
  return f[i] > high + limit || f[i] < low - limit;
}

// Copies the approach without spikes and without what lies outside the range of the
// displacements that the machine reports.
void take_samples(const Measurement& m, const std::vector<double>& reported_m,
                  std::size_t end, const FitRange& range, Approach& approach) {
  const std::span f = std::span(m.force_n).first(end);
  const double limit = std::max(kSpikeDeviations * approach.noise_sd_n,
                                1e-3 * extent(running_median(f, kSpikeReach)));
  for (std::size_t i = 0; i < end; ++i) {
    if (!(reported_m[i] >= range.from_m && reported_m[i] <= range.to_m)) {
      ++approach.out_of_range;
    } else if (is_spike(f, i, limit)) {
      ++approach.spikes;
    } else {
      approach.displacement_m.push_back(m.depth_m[i]);
      approach.force_n.push_back(f[i]);
    }
  }
  if (approach.spikes > 0) {
    approach.flags.push_back(FitFlag::kSpikes);
  }
}

// Contact cannot be found where too few samples are left for it.
void take_baseline(const FitRange& baseline, Approach& approach) {
  const auto& x = approach.displacement_m;
  const auto beyond = std::count_if(x.begin(), x.end(), [&](double value) {
    return value > baseline.to_m;
  });
  if (!(static_cast<std::size_t>(beyond) >= kSamplesMin)) {
    throw InputError(fmt::format(
        "the baseline ends at {} m and leaves {} of {} samples beyond it (up to {} m), "
        "need at least {}",
        baseline.to_m, beyond, x.size(), *std::max_element(x.begin(), x.end()),
        kSamplesMin));
  }
  approach.contact_from_m = baseline.to_m;
}

}  // namespace

Approach select_approach(const Measurement& measurement, const FitRange& range,
                         const std::optional<FitRange>& baseline,
                         const FrameCompliance* frame) {
  check_measurement(measurement);
  if (!(range.from_m < range.to_m)) {
    throw InputError(
        fmt::format("fit range from {} m to {} m is empty", range.from_m, range.to_m));
  }
  const double travel = extent(measurement.depth_m);
  if (!(travel >= kSmallest)) {
    throw InputError(
        fmt::format("the displacement is {} m in all {} samples: no travel",
                    measurement.depth_m.front(), measurement.depth_m.size()));
  }
  // 1. Signs: pressing makes displacement and force grow.
  Approach approach;
  Measurement turned = measurement;
  turn_signs(turned, approach);
  // 2. The approach ends at the largest displacement, or before at the force's peak
  //    where relaxation has taken over.
  std::size_t end = approach_end(turned);
  approach.noise_sd_n = noise_standard_deviation(std::span(turned.force_n).first(end));
  end = before_relaxation(turned, end, approach.noise_sd_n);
  approach.samples = end;
  count_rest(turned, end, approach);
  if (holds_on_its_way(turned, end, approach.noise_sd_n)) {
    approach.flags.push_back(FitFlag::kSeveralHolds);
  }
  if (goes_back(std::span(turned.depth_m).first(end), kHoldTolerance * travel)) {
    approach.flags.push_back(FitFlag::kNonMonotoneDepth);
  }
  // 3. The frame's deflection. The range of the fit stays one of reported
  //    displacements.
  const std::vector<double> reported_m = turned.depth_m;
  if (frame != nullptr) {
    take_off_deflection(*frame, end, turned);
    for (std::size_t i = 0; i < end; ++i) {
      approach.frame_deflection_m =
          std::max(approach.frame_deflection_m, reported_m[i] - turned.depth_m[i]);
    }
  }
  // 4. Work of the loop, of all samples; then the samples of the approach in range.
  close_loop(turned, end - 1, approach);
  take_samples(turned, reported_m, end, range, approach);
  if (approach.force_n.size() < kSamplesMin) {
    throw InputError(fmt::format(
        "the approach has {} samples to fit, need at least {} (of {} samples: {} held, "
        "{} retracting, {} spikes, {} out of range)",
        approach.force_n.size(), kSamplesMin, measurement.force_n.size(),
        approach.hold_samples, approach.retract_samples, approach.spikes,
        approach.out_of_range));
  }
  thin(approach);
  if (baseline) {
    take_baseline(*baseline, approach);
  }
  return approach;
}

Measurement turned(const Measurement& measurement, const Approach& approach) {
  const auto has = [&](FitFlag flag) {
    return std::find(approach.flags.begin(), approach.flags.end(), flag) !=
           approach.flags.end();
  };
  Measurement result = measurement;
  if (has(FitFlag::kDepthSignTurned)) {
    turn(result.depth_m);
  }
  if (has(FitFlag::kForceSignTurned)) {
    turn(result.force_n);
  }
  return result;
}

}  // namespace palpate
