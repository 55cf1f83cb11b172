#include "fitting/curve/power_law_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "fitting/numerics/robust_statistics.h"

namespace palpate {
namespace {

constexpr std::size_t kStarts = 3;
constexpr double kEmptyDeviations = 5.0;
constexpr double kSureDeviations = 3.0;
constexpr double kNoDrift = 2.0 * kDriftShareMax;  // however uncertain
constexpr double kFlatRmsMax = 1.05;  // [-] rms without drift over rms with it

// 1 over the standard deviation of a force, in units of the white noise.
std::vector<double> weights(const Approach& approach, double noise_relative,
                            double force_n) {
  std::vector<double> weight;
  const double noise = std::max(approach.noise_sd_n, 1e-9 * force_n);
  for (const double force : approach.force_n) {
    weight.push_back(noise / std::hypot(noise, noise_relative * force));
  }
  return weight;
}

void hold_at_bounds(const ContactModel& model, double contact_min,
                    HeldParameters& held) {
  constexpr double kClose = 1e-9;
  held[kContact] = held[kContact] || model.contact <= contact_min + kClose ||
                   model.contact >= 1.0 - kClose;
  held[kExponent] = held[kExponent] || model.exponent <= kExponentMin + kClose ||
                    model.exponent >= kExponentMax - kClose;
  held[kCoefficient] = held[kCoefficient] || model.coefficient <= 2.0 * kCoefficientMin;
}

ScaledCurve inliers(const ScaledCurve& curve, const ContactModel& model, double noise) {
  const std::vector<double> r = contact_residuals(curve, model);
  const double limit =
      kOutlierDeviations * std::max(robust_standard_deviation(r), noise) + 1e-12;
  return samples_of(curve, without_outliers(r, limit));
}

// Robust from every start, then plain on the inliers of the best.
PowerLawSolution solve(const ScaledCurve& curve,
                       const std::vector<ContactModel>& starts,
                       const HeldParameters& held, double noise) {
  const ScaledCurve thin = thinned(curve);
  PowerLawSolution solution;
  solution.held = held;
  double least = std::numeric_limits<double>::infinity();
  double loss_scale = 0.0;  // the same for all starts, so that costs compare
  for (const ContactModel& start : starts) {
    if (loss_scale == 0.0) {
      const std::vector<double> r = contact_residuals(thin, start);
      loss_scale = std::max({3.0 * robust_standard_deviation(r), 3.0 * noise, 1e-6});
    }
    const ContactSolveReport report = solve_contact(thin, start, held, loss_scale);
    solution.iterations += report.iterations;
    if (report.cost < least) {
      least = report.cost;
      solution.model = report.model;
    }
  }
  solution.used = inliers(curve, solution.model, noise);
  solution.outliers = curve.x.size() - solution.used.x.size();
  const ContactSolveReport last =
      solve_contact(solution.used, solution.model, held, 0.0);
  solution.model = last.model;
  solution.iterations += last.iterations;
  solution.converged = last.converged;
  return solution;
}

// Whether somebody has said that there is free travel, enough to tell a drift.
bool has_given_free_range(const ScaledCurve& curve) {
  return std::count_if(curve.x.begin(), curve.x.end(), [&](double x) {
           return x < curve.contact_min;
         }) >= static_cast<std::ptrdiff_t>(kFreeSamplesMin);
}

bool has_free_samples(const ScaledApproach& s, const PowerLawSolution& solution) {
  return std::count_if(s.curve.x.begin(), s.curve.x.end(), [&](double x) {
           return x < solution.model.contact;
         }) >= static_cast<std::ptrdiff_t>(kFreeSamplesMin);
}

bool reaches_contact(const ScaledApproach& s, const PowerLawSolution& solution) {
  return std::any_of(s.curve.x.begin(), s.curve.x.end(), [&](double x) {
    return x > solution.model.contact;
  });
}

double rms_of(const PowerLawSolution& solution) {
  return rms(contact_residuals(solution.used, solution.model));
}

// No drift but the body.
bool is_too_steep(const ScaledApproach& s, const PowerLawSolution& solution,
                  std::optional<double> drift_max) {
  const double slope = solution.model.baseline_slope;
  if (drift_max) {
    return slope > *drift_max;
  }
  HeldParameters held = solution.held;
  hold_at_bounds(solution.model, s.curve.contact_min, held);
  const double sd = std::sqrt(contact_covariance(solution.used, solution.model, held)(
      kBaselineSlope, kBaselineSlope));
  return slope > kNoDrift || slope - kSureDeviations * sd > kDriftShareMax;
}

std::vector<ContactModel> flat_starts(std::vector<ContactModel> starts) {
  for (ContactModel& start : starts) {
    start.baseline_slope = 0.0;
  }
  return starts;
}

// The same law with contact point at the first sample and no drift.
PowerLawSolution solve_from_first_sample(const ScaledApproach& s,
                                         std::optional<double> exponent) {
  HeldParameters held{};
  held[kContact] = held[kBaselineSlope] = true;
  held[kExponent] = exponent.has_value();
  std::vector<ContactModel> starts;
  for (const double p : {1.2, 3.0}) {
    starts.push_back(
        {s.curve.f.front(), 0.0, s.curve.contact_min, exponent.value_or(p), 1.0});
  }
  PowerLawSolution solution = solve(s.curve, starts, held, s.noise);
  solution.from_first_sample = true;
  return solution;
}

// Whether the line through the samples before contact surely rises by more than a
// drift would: what is taken for free travel is a toe of the curve.
bool rises_before_contact(const ScaledApproach& s, const PowerLawSolution& solution) {
  std::vector<double> x, f;
  for (std::size_t i = 0; i < s.curve.x.size(); ++i) {
    if (s.curve.x[i] < solution.model.contact) {
      x.push_back(s.curve.x[i]);
      f.push_back(s.curve.f[i]);
    }
  }
  const auto n = std::ssize(x);
  const Eigen::Map<const Eigen::ArrayXd> xs(x.data(), n), fs(f.data(), n);
  const Eigen::ArrayXd dx = xs - xs.mean();
  const double spread = dx.square().sum(), slope = (dx * fs).sum() / spread;
  const double squares = (fs - fs.mean() - slope * dx).square().sum();
  const double sd = std::sqrt(squares / static_cast<double>(n - 2) / spread);
  return slope - kSureDeviations * sd > kDriftShareMax;
}

// Without drift the contact point may be found where with it there was none: a short
// free travel cannot tell drift from contact. Where the law misses, it is enough that
// what it takes for free travel does not rise.
PowerLawSolution solve_without_drift(const ScaledApproach& s,
                                     std::optional<double> exponent,
                                     std::optional<double> drift_max,
                                     const std::vector<ContactModel>& starts,
                                     const PowerLawSolution& with) {
  HeldParameters held{};
  held[kBaselineSlope] = true;
  held[kExponent] = exponent.has_value();
  PowerLawSolution flat = solve(s.curve, flat_starts(starts), held, s.noise);
  const bool found = has_free_samples(s, flat) &&
                     (drift_max || rms_of(flat) <= kFlatRmsMax * rms_of(with)) &&
                     !rises_before_contact(s, flat);
  return found ? flat : solve_from_first_sample(s, exponent);
}

}  // namespace

ScaledApproach scale_approach(const Approach& approach, double noise_relative) {
  ScaledApproach s;
  const auto& x = approach.displacement_m;
  s.x_min_m = *std::min_element(x.begin(), x.end());
  s.length_m = extent(x);
  s.force_n = extent(running_median(approach.force_n, 2));
  if (!(s.force_n > 0.0)) {
    s.force_n = 1.0;  // a constant force, which the empty run's test finds
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    s.curve.x.push_back((x[i] - s.x_min_m) / s.length_m);
    s.curve.f.push_back(approach.force_n[i] / s.force_n);
  }
  if (noise_relative > 0.0) {
    s.curve.weight = weights(approach, noise_relative, s.force_n);
  }
  s.curve.contact_min =
      std::max(0.0, (approach.contact_from_m - s.x_min_m) / s.length_m);
  // A drift is expected within kDriftShareMax: that decides where a short free travel
  // cannot tell it from contact, and is lost among the samples where it can.
  if (!has_given_free_range(s.curve)) {
    s.curve.drift_weight = approach.noise_sd_n / s.force_n / kDriftShareMax;
  }
  s.noise = approach.noise_sd_n / s.force_n;
  return s;
}

bool is_empty(const Approach& approach) {
  const std::vector<double>& f = approach.force_n;
  const std::size_t first = std::max<std::size_t>(4, f.size() / 5);
  const std::vector<double> start(f.begin(),
                                  f.begin() + static_cast<std::ptrdiff_t>(first));
  std::vector<double> step(start.size() - 1);
  for (std::size_t i = 0; i < step.size(); ++i) {
    step[i] = start[i + 1] - start[i];
  }
  const double steps_sd = robust_standard_deviation(step) / std::sqrt(2.0);
  const double sd = std::max(approach.noise_sd_n, steps_sd);
  const std::vector<double> smooth = running_median(f, 3);
  const double rise = *std::max_element(smooth.begin(), smooth.end()) - median(start);
  return !(rise > kEmptyDeviations * sd);
}

PowerLawSolution search_power_law(const ScaledApproach& s,
                                  std::optional<double> exponent,
                                  std::optional<double> drift_max) {
  // 1. Starts by linear fits on a grid; without one, contact from the first sample on.
  HeldParameters held{};
  held[kExponent] = exponent.has_value();
  const auto starts = contact_starts(s.curve, exponent, kStarts);
  PowerLawSolution solution;
  if (starts.empty()) {
    solution = solve_from_first_sample(s, exponent);
  } else {
    solution = solve(s.curve, starts, held, s.noise);
    // 2. Where free travel is given, too steep a drift is held at zero. Otherwise a
    //    drift stays only if free samples are left that show it.
    if (has_given_free_range(s.curve)) {
      if (drift_max && solution.model.baseline_slope > *drift_max) {
        held[kBaselineSlope] = true;
        solution = solve(s.curve, flat_starts(starts), held, s.noise);
      }
    } else if (!has_free_samples(s, solution) || is_too_steep(s, solution, drift_max)) {
      solution = solve_without_drift(s, exponent, drift_max, starts, solution);
    }
  }
  // 3. Without samples in contact the law starts at the first sample.
  if (!reaches_contact(s, solution)) {
    solution = solve_from_first_sample(s, exponent);
  }
  hold_at_bounds(solution.model, s.curve.contact_min, solution.held);
  return solution;
}

}  // namespace palpate
