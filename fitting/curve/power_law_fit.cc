#include "fitting/curve/power_law_fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <Eigen/Core>
#include <fmt/format.h>

#include "fitting/curve/power_law_solve.h"
#include "fitting/curve/power_law_start.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr std::size_t kStarts = 3;
constexpr double kEmptyDeviations = 5.0;
constexpr double kOutlierDeviations = 5.0;
constexpr double kOutlierShareMax = 0.05;  // more is no noise but a law that fails
constexpr double kDriftShareMax = 0.1;  // [-] of the force range, over the whole travel
constexpr double kSureDeviations = 3.0;
constexpr std::ptrdiff_t kFreeSamplesMin = 3;
constexpr double kFlatRmsMax = 1.05;  // [-] rms without drift over rms with it
constexpr double kBeginnings[] = {0.5, 0.25, 0.125};  // [-] of the depth
constexpr double kContactSdShareMax = 0.1;            // [-] of the depth

// The curve in units of its own ranges, and how to get back.
struct Scaling {
  ScaledCurve curve;
  double x_min_m = 0.0;
  double length_m = 0.0;
  double force_n = 0.0;
};

// What the best scaled model is, on which samples, with what held.
struct Solution {
  ContactModel model;
  HeldParameters held{};
  ScaledCurve used;
  std::size_t outliers = 0;
  int iterations = 0;
  bool converged = false;
};

double extent(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

// Whether somebody has said that there is free travel, enough to tell a drift.
bool told_free(const ScaledCurve& curve) {
  return std::count_if(curve.x.begin(), curve.x.end(), [&](double x) {
           return x < curve.contact_min;
         }) >= kFreeSamplesMin;
}

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

Scaling scale(const Approach& approach, const ContactFitOptions& options) {
  Scaling s;
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
  if (options.noise_relative > 0.0) {
    s.curve.weight = weights(approach, options.noise_relative, s.force_n);
  }
  s.curve.contact_min =
      std::max(0.0, (approach.contact_from_m - s.x_min_m) / s.length_m);
  // A drift is expected within kDriftShareMax: that decides where a short free travel
  // cannot tell it from contact, and is lost among the samples where it can.
  if (!told_free(s.curve)) {
    s.curve.drift_weight = approach.noise_sd_n / s.force_n / kDriftShareMax;
  }
  return s;
}

// Whether the force ever leaves the noise of the baseline, which is that of the first
// fifth about its mean slope, or the white noise if that is larger.
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

void hold_at_bounds(const ContactModel& model, double contact_min,
                    HeldParameters& held) {
  constexpr double kClose = 1e-9;
  held[kContact] = held[kContact] || model.contact <= contact_min + kClose ||
                   model.contact >= 1.0 - kClose;
  held[kExponent] = held[kExponent] || model.exponent <= kExponentMin + kClose ||
                    model.exponent >= kExponentMax - kClose;
  held[kCoefficient] = held[kCoefficient] || model.coefficient <= 2.0 * kCoefficientMin;
}

// The samples within kOutlierDeviations of the model; all, if too many are not.
ScaledCurve inliers(const ScaledCurve& curve, const ContactModel& model, double noise) {
  const std::vector<double> r = contact_residuals(curve, model);
  const double limit =
      kOutlierDeviations * std::max(robust_standard_deviation(r), noise) + 1e-12;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (std::abs(r[i]) <= limit) {
      kept.push_back(i);
    }
  }
  const auto left_out = static_cast<double>(r.size() - kept.size());
  return left_out > kOutlierShareMax * static_cast<double>(r.size())
             ? curve
             : samples_of(curve, kept);
}

// Robust from every start, then plain on the inliers of the best.
Solution solve(const ScaledCurve& curve, const std::vector<ContactModel>& starts,
               const HeldParameters& held, double noise) {
  const ScaledCurve thin = thinned(curve);
  Solution solution;
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

std::ptrdiff_t samples_before_contact(const Scaling& s, const Solution& solution) {
  return std::count_if(s.curve.x.begin(), s.curve.x.end(), [&](double x) {
    return x < solution.model.contact;
  });
}

double rms(const std::vector<double>& residuals) {
  double squares = 0.0;
  for (const double r : residuals) {
    squares += r * r;
  }
  return std::sqrt(squares / static_cast<double>(residuals.size()));
}

double rms(const Solution& solution) {
  return rms(contact_residuals(solution.used, solution.model));
}

// A drift that surely lifts the force by more than kDriftShareMax of its range is no
// drift but the body.
bool starts_in_contact(const Scaling& s, const Solution& solution) {
  if (told_free(s.curve)) {
    return false;
  }
  HeldParameters held = solution.held;
  hold_at_bounds(solution.model, s.curve.contact_min, held);
  const double sd = std::sqrt(contact_covariance(solution.used, solution.model, held)(
      kBaselineSlope, kBaselineSlope));
  return samples_before_contact(s, solution) < kFreeSamplesMin ||
         solution.model.baseline_slope - kSureDeviations * sd > kDriftShareMax;
}

std::vector<ContactModel> flat_starts(std::vector<ContactModel> starts) {
  for (ContactModel& start : starts) {
    start.baseline_slope = 0.0;
  }
  return starts;
}

// A short free travel cannot tell drift from contact: without drift the contact point
// may be found where with it there was none.
bool found_without_drift(const Scaling& s, const Solution& with, const Solution& flat) {
  return samples_before_contact(s, flat) >= kFreeSamplesMin &&
         rms(flat) <= kFlatRmsMax * rms(with);
}

// The same law with contact point at the first sample and no drift.
Solution solve_from_first_sample(const Scaling& s, const ContactFitOptions& options,
                                 double noise) {
  HeldParameters held{};
  held[kContact] = held[kBaselineSlope] = true;
  held[kExponent] = options.exponent.has_value();
  std::vector<ContactModel> starts;
  for (const double p : {1.2, 3.0}) {
    starts.push_back({s.curve.f.front(), 0.0, s.curve.contact_min,
                      options.exponent.value_or(p), 1.0});
  }
  return solve(s.curve, starts, held, noise);
}

// Slope of the least-squares line through the samples in contact [N/m].
double mean_stiffness(const Scaling& s, const Solution& solution) {
  std::vector<double> x, f;
  for (std::size_t i = 0; i < solution.used.x.size(); ++i) {
    if (solution.used.x[i] >= solution.model.contact) {
      x.push_back(solution.used.x[i]);
      f.push_back(solution.used.f[i]);
    }
  }
  const auto n = static_cast<Eigen::Index>(x.size());
  const Eigen::Map<const Eigen::ArrayXd> xs(x.data(), n), fs(f.data(), n);
  const Eigen::ArrayXd dx = xs - xs.mean();
  return (dx * fs).sum() / dx.square().sum() * s.force_n / s.length_m;
}

std::string reason_held(const Solution& solution, int parameter,
                        const ContactFitOptions& options, bool assumed) {
  if (parameter == kExponent && options.exponent) {
    return "given";
  }
  if ((assumed && parameter == kContact) ||
      (solution.held[kBaselineSlope] && parameter == kBaselineSlope)) {
    return "assumed";
  }
  const ContactModel& m = solution.model;
  if (!solution.held[static_cast<std::size_t>(parameter)]) {
    return "";
  }
  const double contact_half = 0.5 * (1.0 + solution.used.contact_min);
  const bool upper = (parameter == kContact && m.contact > contact_half) ||
                     (parameter == kExponent && m.exponent > 2.0);
  return upper ? "upper bound" : "lower bound";
}

// Parameters in SI units, and their standard deviations through the derivatives of the
// unscaling.
void unscale(const Scaling& s, const Solution& solution,
             const ContactFitOptions& options, bool assumed, ContactFit& fit) {
  const ContactModel& m = solution.model;
  const double b1 = m.baseline_slope * s.force_n / s.length_m;
  const double K = m.coefficient * s.force_n / std::pow(s.length_m, m.exponent);
  using Matrix = Eigen::Matrix<double, kContactParameters, kContactParameters>;
  Matrix J = Matrix::Zero();
  J(kBaselineForce, kBaselineForce) = s.force_n;
  J(kBaselineForce, kBaselineSlope) = -s.force_n * s.x_min_m / s.length_m;
  J(kBaselineSlope, kBaselineSlope) = s.force_n / s.length_m;
  J(kContact, kContact) = s.length_m;
  J(kExponent, kExponent) = 1.0;
  J(kCoefficient, kCoefficient) = K / m.coefficient;
  J(kCoefficient, kExponent) = -K * std::log(s.length_m);
  const Matrix covariance =
      J * contact_covariance(solution.used, m, solution.held) * J.transpose();
  fit.covariance = covariance;
  const double value[] = {m.baseline_force * s.force_n - b1 * s.x_min_m, b1,
                          s.x_min_m + m.contact * s.length_m, m.exponent, K};
  const char* name[] = {"baseline_force", "baseline_slope", "contact_point", "exponent",
                        "coefficient"};
  const char* unit[] = {"N", "N/m", "m", "", "N/m^p"};
  for (int j = 0; j < kContactParameters; ++j) {
    const std::string held = reason_held(solution, j, options, assumed);
    const double sd = std::sqrt(covariance(j, j));
    fit.parameters.push_back(
        {name[j], value[j], unit[j],
         held.empty() ? sd : std::numeric_limits<double>::quiet_NaN(), held});
    if (held.ends_with("bound")) {
      fit.flags.push_back(FitFlag::kParameterAtBound);
    }
  }
  if (!covariance.allFinite()) {
    fit.flags.push_back(FitFlag::kCovarianceNotAvailable);
  }
  fit.contact_point_m = value[kContact];
  fit.contact_point_sd_m = fit.parameters[kContact].sd;
  fit.exponent = m.exponent;
  fit.coefficient = K;
  fit.coefficient_sd = fit.parameters[kCoefficient].sd;
  fit.depth_max_m = (1.0 - m.contact) * s.length_m;
}

void judge(const Scaling& s, const Solution& solution, bool assumed, ContactFit& fit) {
  fit.samples_used = solution.used.x.size();
  fit.outliers = solution.outliers;
  std::vector<double> residual = contact_residuals(solution.used, solution.model);
  for (double& r : residual) {
    r *= s.force_n;
  }
  fit.rms_n = rms(residual);
  fit.misfit = find_misfit(solution.used.x, residual);
  fit.mean_stiffness_n_per_m = mean_stiffness(s, solution);
  if (assumed) {
    fit.flags.push_back(FitFlag::kAlreadyInContact);
  }
  const bool uncertain =
      !(fit.contact_point_sd_m <= kContactSdShareMax * fit.depth_max_m);
  if (assumed || uncertain) {
    fit.flags.push_back(FitFlag::kContactPointNotIdentified);
  }
  if (matters(fit.misfit, s.force_n)) {
    fit.flags.push_back(FitFlag::kMisfit);
  }
}

ContactFit fit_once(const Approach& approach, const ContactFitOptions& options) {
  if (options.exponent &&
      !(*options.exponent >= kExponentMin && *options.exponent <= kExponentMax)) {
    throw InputError(fmt::format("exponent {} is outside [{}, {}]", *options.exponent,
                                 kExponentMin, kExponentMax));
  }
  ContactFit fit;
  fit.noise_relative = options.noise_relative;
  fit.flags = approach.flags;
  if (is_empty(approach)) {
    fit.family = "none";
    fit.flags.push_back(FitFlag::kEmptyRun);
    fit.flags.push_back(FitFlag::kContactPointNotIdentified);
    fit.converged = true;
    return fit;
  }
  fit.family = "power_law";
  const Scaling s = scale(approach, options);
  const double noise = approach.noise_sd_n / s.force_n;
  HeldParameters held{};
  held[kExponent] = options.exponent.has_value();
  const auto starts = contact_starts(s.curve, options.exponent, kStarts);
  Solution solution;
  bool assumed = starts.empty();
  if (!assumed) {
    solution = solve(s.curve, starts, held, noise);
    assumed = starts_in_contact(s, solution);
  }
  if (assumed && !starts.empty()) {
    held[kBaselineSlope] = true;
    const Solution flat = solve(s.curve, flat_starts(starts), held, noise);
    assumed = !found_without_drift(s, solution, flat);
    solution = flat;
  }
  if (assumed) {
    solution = solve_from_first_sample(s, options, noise);
  }
  hold_at_bounds(solution.model, s.curve.contact_min, solution.held);
  unscale(s, solution, options, assumed, fit);
  judge(s, solution, assumed, fit);
  fit.converged = solution.converged;
  fit.iterations = solution.iterations;
  return fit;
}

// A law that misses the curve is led by all of it: its contact point is known no better
// than it agrees with that of the beginning.
void compare_with_beginning(const Approach& approach, ContactFit& fit) {
  const auto beginning = fit_beginning(approach, fit);
  if (beginning) {
    fit.contact_point_sd_m =
        std::hypot(std::max(fit.contact_point_sd_m, beginning->contact_point_sd_m),
                   fit.contact_point_m - beginning->contact_point_m);
  }
  const bool known =
      beginning && fit.contact_point_sd_m <= kContactSdShareMax * fit.depth_max_m;
  if (!known && !fit.has(FitFlag::kContactPointNotIdentified)) {
    fit.flags.push_back(FitFlag::kContactPointNotIdentified);
  }
}

}  // namespace

bool ContactFit::has(FitFlag flag) const {
  return std::find(flags.begin(), flags.end(), flag) != flags.end();
}

ContactFit fit_contact(const Approach& approach, const ContactFitOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  ContactFit fit = fit_once(approach, options);
  const bool found = fit.converged && !fit.has(FitFlag::kEmptyRun) &&
                     !fit.has(FitFlag::kAlreadyInContact);
  if (found && !options.exponent && is_sure(fit.misfit, extent(approach.force_n))) {
    compare_with_beginning(approach, fit);
  }
  fit.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return fit;
}

std::optional<ContactFit> fit_beginning(const Approach& approach,
                                        const ContactFit& whole) {
  for (const double share : kBeginnings) {
    Approach part = approach;
    part.displacement_m.clear();
    part.force_n.clear();
    std::size_t in_contact = 0;
    for (std::size_t i = 0; i < approach.force_n.size(); ++i) {
      const double depth = approach.displacement_m[i] - whole.contact_point_m;
      if (depth <= share * whole.depth_max_m) {
        part.displacement_m.push_back(approach.displacement_m[i]);
        part.force_n.push_back(approach.force_n[i]);
        in_contact += depth > 0.0 ? 1 : 0;
      }
    }
    if (in_contact < kSamplesMin || part.force_n.size() < 2 * kSamplesMin) {
      break;
    }
    ContactFit fit = fit_once(part, {.noise_relative = whole.noise_relative});
    if (fit.converged && !fit.has(FitFlag::kEmptyRun) &&
        !fit.has(FitFlag::kAlreadyInContact) &&
        !is_sure(fit.misfit, extent(part.force_n))) {
      return fit;
    }
  }
  return std::nullopt;
}

double contact_force_n(const ContactFit& fit, double depth_m) {
  return depth_m > 0.0 ? fit.coefficient * std::pow(depth_m, fit.exponent) : 0.0;
}

}  // namespace palpate
