#include "fitting/curve/law_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "fitting/curve/family_solve.h"
#include "fitting/numerics/correlated_noise.h"
#include "fitting/numerics/robust_statistics.h"

namespace palpate {
namespace {

constexpr double kOutlier = 5.0;  // robust would-be outliers of the fit, left out here

// Columns: 1, x, contact point, exponent, log of the force F at depth D.
using Row = Eigen::Matrix<double, 1, 5>;

struct Law {
  double contact_m, exponent, reference_m, force_n;  // F (d / D)^p

  [[nodiscard]] double at(double x_m) const {
    const double d = x_m - contact_m;
    return d > 0.0 ? force_n * std::pow(d / reference_m, exponent) : 0.0;
  }
  [[nodiscard]] Row gradient(double x_m) const {
    const double d = x_m - contact_m;
    const double f = at(x_m);
    Row row;
    row << 1.0, (x_m - contact_m) / reference_m, d > 0.0 ? -exponent * f / d : 0.0,
        d > 0.0 ? f * std::log(d / reference_m) : 0.0, f;
    return row;
  }
};

}  // namespace

Eigen::VectorXd log_force_errors(const Approach& approach, const ContactFit& fit,
                                 const Eigen::VectorXd& depth_m) {
  const Law law{fit.contact_point_m, fit.exponent, fit.depth_max_m,
                contact_force_n(fit, fit.depth_max_m)};
  std::vector<Eigen::Index> free;
  for (std::size_t j = 0; j < fit.parameters.size(); ++j) {
    if (fit.parameters[j].held.empty()) {
      free.push_back(static_cast<Eigen::Index>(j));
    }
  }
  const double limit_n = kOutlier * std::max(fit.rms_n, approach.noise_sd_n) + 1e-15;
  std::vector<double> all;
  for (std::size_t i = 0; i < approach.force_n.size(); ++i) {
    const double x_m = approach.displacement_m[i];
    all.push_back(fit.parameters[0].value + fit.parameters[1].value * x_m +
                  law.at(x_m) - approach.force_n[i]);
  }
  // sd of ln f at a depth: g^T C g with g = dln f/dq. C is the covariance of the
  // parameters that the fit has left free, under correlated noise.
  const std::vector<std::size_t> used = without_outliers(all, limit_n);
  const auto rows = std::ssize(used);
  Eigen::MatrixXd J(rows, std::ssize(free));
  Eigen::VectorXd r(rows);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const std::size_t i = used[static_cast<std::size_t>(row)];
    r[row] = all[i];
    J.row(row) = law.gradient(approach.displacement_m[i])(free);
  }
  Eigen::VectorXd errors = Eigen::VectorXd::Constant(
      depth_m.size(), std::numeric_limits<double>::infinity());
  const Eigen::MatrixXd C = covariance_under_noise(J, r, rows,
                                                   is_sure(fit.misfit, law.force_n)
                                                       ? SharedNoise::kAlsoSmooth
                                                       : SharedNoise::kAlsoRegression);
  if (!C.allFinite()) {
    return errors;
  }
  for (Eigen::Index k = 0; k < depth_m.size(); ++k) {
    Row g = Row::Zero();  // of log f at a depth from the contact point
    g[3] = std::log(depth_m[k] / law.reference_m);
    g[4] = 1.0;
    const Eigen::VectorXd gradient = g(free).transpose();
    errors[k] = std::sqrt(gradient.dot(C * gradient));
  }
  return errors;
}

Eigen::VectorXd log_force_errors(const FamilyFit& fit, const Eigen::VectorXd& depth_m) {
  const Eigen::Index p = fit.scaled.size() - kFamilyShared;
  const Eigen::VectorXd q = fit.scaled.tail(p);
  const Eigen::MatrixXd C = fit.covariance.bottomRightCorner(p, p);
  const bool given = fit.parameters[kFamilyContact].held == "power law";
  Eigen::VectorXd gradient(p), errors(depth_m.size());
  for (Eigen::Index k = 0; k < depth_m.size(); ++k) {
    const auto count = static_cast<std::size_t>(p);
    fit.curve->gradient({q.data(), count}, depth_m[k] / fit.length_m,
                        {gradient.data(), count});
    const FamilyPoint at = family_point(fit, depth_m[k]);
    // A contact point that was given has no column in C: its error moves the curve.
    const double moved = given ? fit.contact_point_sd_m * at.slope : 0.0;
    const double shape = fit.force_n * std::sqrt(gradient.dot(C * gradient));
    const double error = std::hypot(shape, moved) / at.force;
    errors[k] = at.force > 0.0 && std::isfinite(error)
                    ? error
                    : std::numeric_limits<double>::infinity();
  }
  return errors;
}

}  // namespace palpate
