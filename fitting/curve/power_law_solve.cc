#include "fitting/curve/power_law_solve.h"

#include <cmath>
#include <vector>

#include "fitting/numerics/least_squares.h"

namespace palpate {
namespace {

// Residuals at q, and their derivatives where asked for. ln d serves the power and its
// derivative by the exponent.
void power_law_residuals(const ScaledCurve& curve, const double* q, double* r,
                         RowMajorMatrix* jacobian) {
  const double p = q[kExponent], K = q[kCoefficient];
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const double x = curve.x[i], d = x - q[kContact];
    const double log_d = d > 0.0 ? std::log(d) : 0.0;
    const double power = d > 0.0 ? std::exp(p * log_d) : 0.0;
    const double w = curve.weight.empty() ? 1.0 : curve.weight[i];
    r[i] = w * (q[kBaselineForce] + q[kBaselineSlope] * x + K * power - curve.f[i]);
    if (jacobian != nullptr) {
      double* row = jacobian->data() + i * kContactParameters;
      row[kBaselineForce] = w;
      row[kBaselineSlope] = w * x;
      row[kContact] = d > 0.0 ? -w * K * p * power / d : 0.0;
      row[kExponent] = w * K * power * log_d;
      row[kCoefficient] = w * power;
    }
  }
}

Eigen::VectorXd as_vector(const ContactModel& m) {
  Eigen::VectorXd q(int{kContactParameters});
  q << m.baseline_force, m.baseline_slope, m.contact, m.exponent, m.coefficient;
  return q;
}

LeastSquaresProblem contact_problem(const ScaledCurve& curve,
                                    const HeldParameters& held) {
  // r_i = w_i (b0 + b1 x_i + K <x_i - c>^p - f_i). With drift_weight a last residual
  // expects no drift: r = drift_weight b1.
  LeastSquaresProblem problem;
  const bool weighed = curve.drift_weight > 0.0;
  problem.residuals = static_cast<int>(curve.x.size()) + (weighed ? 1 : 0);
  problem.in_a_row = static_cast<int>(curve.x.size());
  problem.evaluate = [&curve, weighed](const Eigen::VectorXd& q,
                                       Eigen::Ref<Eigen::VectorXd> r,
                                       RowMajorMatrix* jacobian) {
    power_law_residuals(curve, q.data(), r.data(), jacobian);
    const auto last = static_cast<Eigen::Index>(curve.x.size());
    if (weighed) {
      r[last] = curve.drift_weight * q[kBaselineSlope];
    }
    if (weighed && jacobian != nullptr) {
      jacobian->row(last).setZero();
      (*jacobian)(last, kBaselineSlope) = curve.drift_weight;
    }
    return true;
  };
  problem.lower.resize(int{kContactParameters});
  problem.upper.resize(int{kContactParameters});
  problem.lower << -kInf, -kInf, curve.contact_min, kExponentMin, kCoefficientMin;
  problem.upper << kInf, kInf, 1.0, kExponentMax, kInf;
  problem.held.assign(held.begin(), held.end());
  return problem;
}

}  // namespace

ContactSolveReport solve_contact(const ScaledCurve& curve, const ContactModel& start,
                                 const HeldParameters& held, double loss_scale) {
  LeastSquaresOptions options;
  options.loss_scale = loss_scale;
  // With a loss it only has to find the inliers.
  options.tolerance = loss_scale > 0.0 ? 1e-6 : 1e-13;
  const LeastSquaresReport report =
      solve_least_squares(contact_problem(curve, held), as_vector(start), options);
  const Eigen::VectorXd& q = report.q;
  return {{q[kBaselineForce], q[kBaselineSlope], q[kContact], q[kExponent],
           q[kCoefficient]},
          report.cost,
          report.iterations,
          report.converged};
}

std::vector<double> contact_residuals(const ScaledCurve& curve,
                                      const ContactModel& model) {
  std::vector<double> residuals(curve.x.size());
  power_law_residuals(curve, as_vector(model).data(), residuals.data(), nullptr);
  return residuals;
}

Eigen::Matrix<double, kContactParameters, kContactParameters> contact_covariance(
    const ScaledCurve& curve, const ContactModel& model, const HeldParameters& held,
    SharedNoise kinds) {
  LeastSquaresProblem problem = contact_problem(curve, held);
  problem.lower.resize(0);  // the caller holds what stands at a bound
  problem.upper.resize(0);
  return least_squares_covariance(problem, as_vector(model), kinds);
}

}  // namespace palpate
