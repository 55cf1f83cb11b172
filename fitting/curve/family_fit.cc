#include "fitting/curve/family_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "fitting/curve/family_rank.h"
#include "fitting/curve/family_solve.h"
#include "fitting/curve/power_law_solve.h"
#include "fitting/curve/power_law_start.h"
#include "fitting/numerics/least_squares.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr int kFeaturePoints = 200;
constexpr std::size_t kForceReach = 2;  // neighbours of a running median
constexpr int kFolds = 5, kBlocks = 20;
constexpr std::size_t kCrossSamples = 300;

double reference_force(const ContactFit& reference, double x) {
  return reference.parameters[0].value + reference.parameters[1].value * x +
         contact_force_n(reference, x - reference.contact_point_m);
}

// Whether there is a force in contact.
bool has_contact(const FamilyChoice& choice, double contact_m) {
  const std::vector<double>& x = choice.displacement_m;
  return !x.empty() && *std::max_element(x.begin(), x.end()) > contact_m &&
         extent(running_median(choice.force_n, kForceReach)) > 0.0;
}

// The approach without the reference's outliers; with them where they are all there is
// of contact.
void take_inliers(const Approach& approach, const ContactFit& reference,
                  FamilyChoice& choice) {
  const std::size_t n = approach.force_n.size();
  std::vector<double> residual(n);
  for (std::size_t i = 0; i < n; ++i) {
    residual[i] =
        approach.force_n[i] - reference_force(reference, approach.displacement_m[i]);
  }
  const double limit =
      kOutlierDeviations *
      std::max(robust_standard_deviation(residual), approach.noise_sd_n);
  for (const std::size_t i : without_outliers(residual, limit)) {
    choice.displacement_m.push_back(approach.displacement_m[i]);
    choice.force_n.push_back(approach.force_n[i]);
  }
  if (!has_contact(choice, reference.contact_point_m)) {
    choice.displacement_m = approach.displacement_m;
    choice.force_n = approach.force_n;
  }
  choice.outliers = n - choice.force_n.size();
}

FamilyData scaled_data(const FamilyChoice& choice, const Approach& approach,
                       const ContactFit& reference) {
  FamilyData data;
  // x = (displacement - contact point) / depth, f = force / its range.
  data.x_origin_m = reference.contact_point_m;
  data.length_m =
      *std::max_element(choice.displacement_m.begin(), choice.displacement_m.end()) -
      data.x_origin_m;
  data.force_n = extent(running_median(choice.force_n, kForceReach));
  const auto n = static_cast<Eigen::Index>(choice.force_n.size());
  data.x.resize(n);
  data.f.resize(n);
  data.weight.resize(n);
  const double noise = std::max(approach.noise_sd_n, 1e-9 * data.force_n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    data.x[i] = (choice.displacement_m[k] - data.x_origin_m) / data.length_m;
    data.f[i] = choice.force_n[k] / data.force_n;
    // Noise with a part in proportion to the force: weight = s / hypot(s, relative F).
    data.weight[i] =
        noise / std::hypot(noise, reference.noise_relative * choice.force_n[k]);
  }
  data.contact_min = data.x.minCoeff();
  data.contact_min =
      std::clamp((approach.contact_from_m - data.x_origin_m) / data.length_m,
                 data.contact_min, 0.9);
  data.contact_held = reference.has(FitFlag::kAlreadyInContact);
  data.flat = data.contact_held || !reference.parameters[1].held.empty();
  // Baseline b0 + b1 X of displacement X, in x: b0 + b1 x_origin and b1 L, over F.
  data.baseline_slope = reference.parameters[1].value * data.length_m / data.force_n;
  data.baseline_force = (reference.parameters[0].value +
                         reference.parameters[1].value * data.x_origin_m) /
                        data.force_n;
  return data;
}

std::vector<double> residuals(const FamilyData& data, const CurveFamily& family,
                              const Eigen::VectorXd& q) {
  std::vector<double> r(static_cast<std::size_t>(data.x.size()));
  for (Eigen::Index i = 0; i < data.x.size(); ++i) {
    r[static_cast<std::size_t>(i)] =
        data.weight[i] * (scaled_force(family, q, data.x[i]) - data.f[i]);
  }
  return r;
}

double sum_of_squares(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value * value;
  }
  return sum;
}

FamilyParameter joint_parameter(const CurveFamily& family, Eigen::Index j) {
  static constexpr FamilyParameter kShared[] = {
      {"baseline_force", "N", -kInf, kInf, 1, 0},
      {"baseline_slope", "N/m", -kInf, kInf, 1, -1},
      {"contact_point", "m", -kInf, kInf, 0, 1}};
  return j < kFamilyShared
             ? kShared[j]
             : family.parameters()[static_cast<std::size_t>(j - kFamilyShared)];
}

// Scaled parameters and their covariance in SI units.
void unscale_family(const FamilyData& data, const std::vector<std::string>& held,
                    FamilyFit& fit) {
  // SI value = F^force_power L^length_power times the scaled one.
  const double F = data.force_n, L = data.length_m;
  for (Eigen::Index j = 0; j < fit.scaled.size(); ++j) {
    const FamilyParameter p = joint_parameter(*fit.curve, j);
    const double si = std::pow(F, p.force_power) * std::pow(L, p.length_power);
    FitParameter out;
    out.name = p.name;
    if (p.name == "curvature" || p.name == "force") {
      out.name += fmt::format("_{}", j - kFamilyShared);
    }
    out.unit = p.unit;
    out.value = si * fit.scaled[j];
    out.sd = si * std::sqrt(fit.covariance(j, j));
    out.held = held[static_cast<std::size_t>(j)];
    if (!out.held.empty()) {
      out.sd = std::nan("");
    }
    if (out.held.ends_with("bound")) {
      fit.at_bound.push_back(out.name);
    }
    fit.parameters.push_back(out);
  }
  // The baseline's force moves from x = 0 to displacement 0: b0 = F q0 - (F / L) origin
  // q1.
  const double origin = data.x_origin_m;
  fit.parameters[0].value -= fit.parameters[1].value * origin;
  const Eigen::Vector2d to_zero(F, -F * origin / L);
  if (fit.parameters[0].held.empty()) {
    fit.parameters[0].sd =
        std::sqrt(to_zero.dot(fit.covariance.topLeftCorner<2, 2>() * to_zero));
  }
  fit.parameters[2].value += origin;
  fit.contact_point_m = fit.parameters[2].value;
  fit.contact_point_sd_m = fit.parameters[2].sd;
}

// What follows from the scaled parameters.
void finish_fit(const FamilyData& data, const std::vector<std::string>& held,
                FamilyFit& fit) {
  const std::vector<double> r = residuals(data, *fit.curve, fit.scaled);
  fit.rms_n =
      data.force_n * std::sqrt(sum_of_squares(r) / static_cast<double>(r.size()));
  fit.depth_max_m = data.length_m * (data.x.maxCoeff() - fit.scaled[kFamilyContact]);
  unscale_family(data, held, fit);
}

FamilyFit fit_one(const FamilyData& data, std::string_view name, double contact,
                  bool contact_free) {
  const FamilySolution solution = solve_family(data, name, contact, contact_free);
  FamilyFit fit;
  fit.family = name;
  fit.curve = solution.family;
  fit.scaled = solution.q;
  fit.converged = solution.converged;
  fit.iterations = solution.iterations;
  fit.x_origin_m = data.x_origin_m;
  fit.length_m = data.length_m;
  fit.force_n = data.force_n;
  fit.free_parameters = solution.free_parameters;
  fit.covariance = solution.covariance;
  finish_fit(data, solution.held, fit);
  return fit;
}

// The reference itself, in this data's units.
FamilyFit power_law(const FamilyData& data, const ContactFit& reference) {
  const double F = data.force_n, L = data.length_m, origin = data.x_origin_m;
  const double b0 = reference.parameters[0].value, b1 = reference.parameters[1].value;
  const double p = reference.exponent;
  const double force = reference.coefficient * std::pow(L, p);  // at the depth L
  FamilyFit fit;
  fit.family = "power-law";
  fit.curve = power_law_family();
  fit.converged = reference.converged;
  fit.iterations = reference.iterations;
  fit.x_origin_m = origin;
  fit.length_m = L;
  fit.force_n = F;
  fit.scaled.resize(5);
  fit.scaled << (b0 + b1 * origin) / F, b1 * L / F,
      (reference.contact_point_m - origin) / L, force / F, p;
  using Matrix = Eigen::Matrix<double, 5, 5>;
  Matrix J =
      Matrix::Zero();  // by baseline, drift, contact point, exponent, coefficient
  J(kFamilyForce, kBaselineForce) = 1.0 / F;
  J(kFamilyForce, kBaselineSlope) = origin / F;
  J(kFamilySlope, kBaselineSlope) = L / F;
  J(kFamilyContact, kContact) = 1.0 / L;
  J(kFamilyShared, kExponent) = force / F * std::log(L);
  J(kFamilyShared, kCoefficient) = std::pow(L, p) / F;
  J(kFamilyShared + 1, kExponent) = 1.0;
  fit.covariance = J * reference.covariance * J.transpose();
  std::vector<std::string> held;
  for (const FitParameter& parameter : reference.parameters) {
    held.push_back(parameter.held);
    fit.free_parameters += parameter.held.empty() ? 1 : 0;
  }
  std::swap(held[kExponent], held[kCoefficient]);  // the family's order
  finish_fit(data, held, fit);
  fit.contact_point_sd_m = std::hypot(reference.contact.sd_m,
                                      reference.contact.m - reference.contact_point_m);
  return fit;
}

// Root mean square error at blocks of neighbouring samples that the fit had not seen.
double cross_validated(const FamilyData& all, const FamilyFit& fit, bool contact_free) {
  const Eigen::Index step = std::max<Eigen::Index>(
      1, all.x.size() / static_cast<Eigen::Index>(kCrossSamples));
  const Eigen::Index n = all.x.size() / step;
  double squares = 0.0;
  for (int fold = 0; fold < kFolds; ++fold) {
    std::vector<Eigen::Index> seen, unseen;
    for (Eigen::Index i = 0; i < n; ++i) {
      (i * kBlocks / n % kFolds == fold ? unseen : seen).push_back(i * step);
    }
    FamilyData part = all;
    part.x = all.x(seen);
    part.f = all.f(seen);
    part.weight = all.weight(seen);
    const FamilySolution solution = solve_family(
        part, fit.family, fit.scaled[kFamilyContact], contact_free, &fit.scaled);
    for (const Eigen::Index i : unseen) {
      const double error =
          scaled_force(*solution.family, solution.q, all.x[i]) - all.f[i];
      squares += error * error;
    }
  }
  return all.force_n * std::sqrt(squares / static_cast<double>(n));
}

// By the noise of the family that misses least, or of what is free.
void find_misfits(const FamilyData& data, double free_to_m, FamilyChoice& choice) {
  const auto residuals_of = [&](const FamilyFit& fit) {
    std::vector<double> r = residuals(data, *fit.curve, fit.scaled);
    for (double& value : r) {
      value *= data.force_n;
    }
    return r;
  };
  const auto closest = std::min_element(choice.fits.begin(), choice.fits.end(),
                                        [](const auto& a, const auto& b) {
                                          return a.rms_n < b.rms_n;
                                        });
  const auto& x = choice.displacement_m;
  const auto free = std::find_if(x.begin(), x.end(), [&](double at) {
    return !(at < free_to_m);
  });
  const ResidualNoise noise(x, residuals_of(*closest),
                            static_cast<std::size_t>(free - x.begin()));
  choice.noise_sd_n = noise.noise_sd();
  choice.independent_samples = noise.independent_samples();
  for (FamilyFit& fit : choice.fits) {
    fit.misfit = noise.misfit(residuals_of(fit));
    fit.misses = matters(fit.misfit, data.force_n);
    fit.deviance = noise.deviance(residuals_of(fit));
  }
}

// A force that is clipped is no plateau.
std::vector<CurveFeature> features_of(const FamilyChoice& choice,
                                      const Approach& approach) {
  const FamilyFit& fit = choice.fits.front();
  std::vector<double> depth, force;
  for (int i = 0; i <= kFeaturePoints; ++i) {
    depth.push_back(fit.depth_max_m * i / kFeaturePoints);
    force.push_back(family_point(fit, depth.back()).force);
  }
  std::vector<CurveFeature> found = find_features(depth, force, choice.noise_sd_n);
  if (auto clipped = find_clipped_force(approach.displacement_m, approach.force_n)) {
    std::erase_if(found, [](const CurveFeature& feature) {
      return feature.kind != FeatureKind::kFall;
    });
    clipped->depth_m -= fit.contact_point_m;
    clipped->depth_end_m -= fit.contact_point_m;
    found.push_back(*clipped);
  }
  return found;
}

FamilyFit fit_named(const std::string& name, const FamilyData& data,
                    const FamilyFit& law, double contact_sd_m,
                    const FamilyFitOptions& options) {
  const bool free = !data.contact_held;
  const bool joint = free && has_contact_of_its_own(name);
  FamilyFit fit = name == law.family ? law : fit_one(data, name, 0.0, joint);
  fit.cross_rms_n =
      options.cross_validate ? cross_validated(data, fit, joint) : std::nan("");
  if (free && !joint) {
    fit.contact_point_sd_m = contact_sd_m;
    fit.free_parameters += 1;  // the contact point that the power law found
  }
  return fit;
}

}  // namespace

FamilyChoice fit_families(const Approach& approach, const ContactFit& reference,
                          const std::vector<std::string>& families,
                          const std::string& criterion,
                          const FamilyFitOptions& options) {
  FamilyChoice choice;
  choice.criterion = criterion;
  if (reference.has(FitFlag::kEmptyRun)) {
    return choice;
  }
  take_inliers(approach, reference, choice);
  // A law that misses leads those that have no contact point of their own astray.
  const bool astray = reference.has(FitFlag::kMisfit) ||
                      reference.has(FitFlag::kContactPointNotIdentified);
  const ContactFit& start =
      astray && reference.beginning ? *reference.beginning : reference;
  const FamilyData data = scaled_data(choice, approach, start);
  const FamilyFit law = power_law(data, reference);
  FamilyFitOptions with = options;
  with.cross_validate = options.cross_validate || criterion == "cross-validation";
  for (const std::string& name : families) {
    choice.fits.push_back(fit_named(name, data, law, start.contact.sd_m, with));
  }
  find_misfits(data, reference.free_to_m, choice);
  rank_fits(choice);
  choice.features = features_of(choice, approach);
  return choice;
}

FamilyPoint family_point(const FamilyFit& fit, double depth_m) {
  const Eigen::VectorXd q = fit.scaled.tail(fit.scaled.size() - kFamilyShared);
  const FamilyPoint p = fit.curve->at({q.data(), static_cast<std::size_t>(q.size())},
                                      depth_m / fit.length_m);
  return {p.force * fit.force_n, p.slope * fit.force_n / fit.length_m,
          p.energy * fit.force_n * fit.length_m};
}

double fitted_force_n(const FamilyFit& fit, double displacement_m) {
  return fit.force_n * scaled_force(*fit.curve, fit.scaled,
                                    (displacement_m - fit.x_origin_m) / fit.length_m);
}

double fitted_sd_n(const FamilyFit& fit, double displacement_m) {
  const double x = (displacement_m - fit.x_origin_m) / fit.length_m;
  const Eigen::VectorXd row = scaled_gradient(*fit.curve, fit.scaled, x);
  return fit.force_n * std::sqrt(row.dot(fit.covariance * row));
}

}  // namespace palpate
