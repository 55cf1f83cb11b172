#include "fitting/curve/power_law_once.h"

#include <cmath>
#include <limits>

#include <Eigen/Core>

#include "fitting/curve/power_law_search.h"
#include "fitting/numerics/robust_statistics.h"

namespace palpate {
namespace {

// Slope of the least-squares line through the samples in contact [N/m]; NaN where they
// are too few for a line.
double mean_stiffness(const ScaledApproach& s, const PowerLawSolution& solution) {
  std::vector<double> x, f;
  for (std::size_t i = 0; i < solution.used.x.size(); ++i) {
    if (solution.used.x[i] >= solution.model.contact) {
      x.push_back(solution.used.x[i]);
      f.push_back(solution.used.f[i]);
    }
  }
  if (x.size() < 2) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto n = static_cast<Eigen::Index>(x.size());
  const Eigen::Map<const Eigen::ArrayXd> xs(x.data(), n), fs(f.data(), n);
  const Eigen::ArrayXd dx = xs - xs.mean();
  return (dx * fs).sum() / dx.square().sum() * s.force_n / s.length_m;
}

std::string reason_held(const PowerLawSolution& solution, int parameter,
                        const ContactFitOptions& options) {
  if (parameter == kExponent && options.exponent) {
    return "given";
  }
  if ((solution.from_first_sample && parameter == kContact) ||
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
void unscale(const ScaledApproach& s, const PowerLawSolution& solution,
             const ContactFitOptions& options, ContactFit& fit) {
  const ContactModel& m = solution.model;
  // b0 + b1 x + K (x - c)^p over force_n, with x = (X - x_min) / L, in SI units:
  //   b1' = b1 F / L,  b0' = b0 F - b1' x_min,  c' = x_min + c L,  K' = K F / L^p
  // J holds the derivatives of b0', b1', c', p and K'; F = force_n, L = length_m.
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
  const Matrix covariance = J *
                            contact_covariance(solution.used, m, solution.held,
                                               SharedNoise::kAlsoRegression) *
                            J.transpose();
  fit.covariance = covariance;
  const double value[] = {m.baseline_force * s.force_n - b1 * s.x_min_m, b1,
                          s.x_min_m + m.contact * s.length_m, m.exponent, K};
  const char* name[] = {"baseline_force", "baseline_slope", "contact_point", "exponent",
                        "coefficient"};
  const char* unit[] = {"N", "N/m", "m", "", "N/m^p"};
  for (int j = 0; j < kContactParameters; ++j) {
    const std::string held = reason_held(solution, j, options);
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

void compare_with_samples(const ScaledApproach& s, const PowerLawSolution& solution,
                          ContactFit& fit) {
  fit.samples_used = solution.used.x.size();
  fit.outliers = solution.outliers;
  std::vector<double> residual = contact_residuals(solution.used, solution.model);
  for (double& r : residual) {
    r *= s.force_n;
  }
  fit.rms_n = rms(residual);
  fit.misfit = find_misfit(solution.used.x, residual);
}

void raise_flags(const ScaledApproach& s, const PowerLawSolution& solution,
                 ContactFit& fit) {
  fit.mean_stiffness_n_per_m = mean_stiffness(s, solution);
  if (solution.from_first_sample) {
    fit.flags.push_back(FitFlag::kAlreadyInContact);
  }
  fit.contact = {fit.contact_point_m, fit.contact_point_sd_m};
  if (solution.from_first_sample || !is_known(fit)) {
    fit.flags.push_back(FitFlag::kContactPointNotIdentified);
  }
  if (matters(fit.misfit, s.force_n)) {
    fit.flags.push_back(FitFlag::kMisfit);
  }
}

ContactFit empty_run(ContactFit fit) {
  fit.family = "none";
  fit.flags.push_back(FitFlag::kEmptyRun);
  fit.flags.push_back(FitFlag::kContactPointNotIdentified);
  fit.converged = true;
  return fit;
}

}  // namespace

bool is_known(const ContactFit& fit) {
  return fit.contact.sd_m <= kContactSdShareMax * fit.depth_max_m;
}

ContactFit fit_once(const Approach& approach, const ContactFitOptions& options,
                    std::optional<double> drift_max_n_per_m) {
  ContactFit fit;
  fit.noise_relative = options.noise_relative;
  fit.flags = approach.flags;
  if (is_empty(approach)) {
    return empty_run(fit);
  }
  fit.family = "power_law";
  const ScaledApproach s = scale_approach(approach, options.noise_relative);
  std::optional<double> drift_max;
  if (drift_max_n_per_m) {
    drift_max = *drift_max_n_per_m * s.length_m / s.force_n;
  }
  const PowerLawSolution solution = search_power_law(s, options.exponent, drift_max);
  compare_with_samples(s, solution, fit);
  unscale(s, solution, options, fit);
  raise_flags(s, solution, fit);
  fit.converged = solution.converged;
  if (!fit.converged) {
    fit.flags.push_back(FitFlag::kNotConverged);
  }
  fit.iterations = solution.iterations;
  return fit;
}

}  // namespace palpate
