#include "fitting/numerics/interval_estimate.h"

#include <cmath>
#include <numbers>

#include "fitting/numerics/robust_statistics.h"

namespace palpate {
namespace {

constexpr double kStepShare = 1e-2;  // [-] of a standard deviation
constexpr const char* kNotDetermined = "the data do not determine it";

// Integral of the normal distribution function from minus infinity to x.
double integral_of_normal(double x) {
  return 0.5 * x * std::erfc(-x / std::numbers::sqrt2) +
         std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
}

// Probability of N + U <= h.
double probability_below(double h, double sd, double half) {
  return sd / (2.0 * half) *
         (integral_of_normal((h + half) / sd) - integral_of_normal((h - half) / sd));
}

}  // namespace

IntervalEstimate refused_estimate(const std::string& why, double above) {
  IntervalEstimate none;
  none.refused = why;
  none.above = above;
  return none;
}

double half_interval_95(double sd, double half) {
  if (!(half > 1e-6 * sd)) {
    return kNormal95 * sd;
  }
  if (!(sd > 1e-6 * half)) {
    return 0.95 * half;
  }
  double low = 0.0, high = half + kNormal95 * sd;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (2.0 * probability_below(middle, sd, half) - 1.0 < 0.95 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

IntervalEstimate estimate(const std::function<double(const Eigen::VectorXd&)>& quantity,
                          const Eigen::VectorXd& q, const Eigen::MatrixXd& covariance,
                          double half) {
  if (!covariance.allFinite()) {
    return refused_estimate(kNotDetermined);
  }
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(q.size());
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const double step = kStepShare * std::sqrt(covariance(j, j));
    if (step > 0.0) {
      Eigen::VectorXd above = q, below = q;
      above[j] += step;
      below[j] -= step;
      slope[j] = (quantity(above) - quantity(below)) / (2.0 * step);
    }
  }
  IntervalEstimate found;
  found.value = quantity(q);
  const double normal = std::sqrt(std::max(0.0, slope.dot(covariance * slope)));
  found.sd = std::sqrt(normal * normal + half * half / 3.0);
  const double reach = half_interval_95(normal, half);
  found.low = found.value - reach;
  found.high = found.value + reach;
  return std::isfinite(found.value + found.sd) ? found
                                               : refused_estimate(kNotDetermined);
}

IntervalEstimate estimate_of_log(
    const std::function<double(const Eigen::VectorXd&)>& log_quantity,
    const Eigen::VectorXd& q, const Eigen::MatrixXd& covariance) {
  IntervalEstimate found = estimate(log_quantity, q, covariance);
  if (found.refused.empty()) {
    found.value = std::exp(found.value);
    found.sd *= found.value;
    found.low = std::exp(found.low);
    found.high = std::exp(found.high);
  }
  return found;
}

}  // namespace palpate
