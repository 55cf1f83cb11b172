#include "fitting/contact_solve.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <vector>

#include <Eigen/QR>
#include <ceres/ceres.h>

namespace palpate {
namespace {

using Row = Eigen::Matrix<double, 1, kContactParameters>;

// Residual of the model at (x, f), and its derivatives where `row` is given.
double residual(const double* q, double x, double f, Row* row) {
  const double d = std::max(x - q[kContact], 0.0);
  const double power = d > 0.0 ? std::pow(d, q[kExponent]) : 0.0;
  if (row != nullptr) {
    const double K = q[kCoefficient];
    *row << 1.0, x, d > 0.0 ? -K * q[kExponent] * power / d : 0.0,
        d > 0.0 ? K * power * std::log(d) : 0.0, power;
  }
  return q[kBaselineForce] + q[kBaselineSlope] * x + q[kCoefficient] * power - f;
}

class ContactResidual : public ceres::SizedCostFunction<1, 1, 1, 1, 1, 1> {
 public:
  ContactResidual(double x, double f) : x_(x), f_(f) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    std::array<double, kContactParameters> q{};
    for (std::size_t j = 0; j < q.size(); ++j) {
      q[j] = *parameters[j];
    }
    Row row;
    residuals[0] = residual(q.data(), x_, f_, jacobians != nullptr ? &row : nullptr);
    for (int j = 0; jacobians != nullptr && j < kContactParameters; ++j) {
      if (jacobians[j] != nullptr) {
        jacobians[j][0] = row[j];
      }
    }
    return std::isfinite(residuals[0]);
  }

 private:
  double x_, f_;
};

std::array<double, kContactParameters> as_array(const ContactModel& m) {
  return {m.baseline_force, m.baseline_slope, m.contact, m.exponent, m.coefficient};
}

ceres::Solver::Options solver_options(bool final) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 200;
  // The defaults stop early; the last solve ends at the accuracy of the numbers.
  options.function_tolerance = final ? 1e-14 : 1e-8;
  options.gradient_tolerance = final ? 1e-13 : 1e-10;
  options.parameter_tolerance = final ? 1e-12 : 1e-6;
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace

ContactSolveReport solve_contact(const ScaledCurve& curve, const ContactModel& start,
                                 const HeldParameters& held, double loss_scale) {
  auto q = as_array(start);
  q[kCoefficient] = std::max(q[kCoefficient], kCoefficientMin);
  std::deque<ContactResidual> residuals;  // Ceres keeps their addresses
  ceres::CauchyLoss cauchy(loss_scale > 0.0 ? loss_scale : 1.0);
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    residuals.emplace_back(curve.x[i], curve.f[i]);
    problem.AddResidualBlock(&residuals.back(), loss_scale > 0.0 ? &cauchy : nullptr,
                             &q[0], &q[1], &q[2], &q[3], &q[4]);
  }
  problem.SetParameterLowerBound(&q[kContact], 0, 0.0);
  problem.SetParameterUpperBound(&q[kContact], 0, 1.0);
  problem.SetParameterLowerBound(&q[kExponent], 0, kExponentMin);
  problem.SetParameterUpperBound(&q[kExponent], 0, kExponentMax);
  problem.SetParameterLowerBound(&q[kCoefficient], 0, kCoefficientMin);
  for (std::size_t j = 0; j < held.size(); ++j) {
    if (held[j]) {
      problem.SetParameterBlockConstant(&q[j]);
    }
  }
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(loss_scale == 0.0), &problem, &summary);
  return {{q[0], q[1], q[2], q[3], q[4]},
          summary.final_cost,
          static_cast<int>(summary.iterations.size()),
          summary.termination_type == ceres::CONVERGENCE};
}

std::vector<double> contact_residuals(const ScaledCurve& curve,
                                      const ContactModel& model) {
  const auto q = as_array(model);
  std::vector<double> residuals(curve.x.size());
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    residuals[i] = residual(q.data(), curve.x[i], curve.f[i], nullptr);
  }
  return residuals;
}

Eigen::Matrix<double, kContactParameters, kContactParameters> contact_covariance(
    const ScaledCurve& curve, const ContactModel& model, const HeldParameters& held) {
  const auto q = as_array(model);
  const auto n = static_cast<Eigen::Index>(curve.x.size());
  std::vector<int> free;
  for (int j = 0; j < kContactParameters; ++j) {
    if (!held[static_cast<std::size_t>(j)]) {
      free.push_back(j);
    }
  }
  const auto p = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd J(n, p);
  double squares = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    Row row;
    const auto k = static_cast<std::size_t>(i);
    const double r = residual(q.data(), curve.x[k], curve.f[k], &row);
    squares += r * r;
    J.row(i) = row(free);
  }
  Eigen::Matrix<double, kContactParameters, kContactParameters> covariance;
  covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
  const Eigen::VectorXd scale = J.colwise().norm();
  if (n <= p || !(scale.minCoeff() > 0.0)) {
    return covariance;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(J * scale.cwiseInverse().asDiagonal());
  qr.setThreshold(1e-10);
  if (qr.rank() < p) {
    return covariance;
  }
  const Eigen::MatrixXd inverse =
      qr.colsPermutation() *
      Eigen::MatrixXd(qr.matrixR()
                          .topLeftCorner(p, p)
                          .template triangularView<Eigen::Upper>()
                          .solve(Eigen::MatrixXd::Identity(p, p)));
  const Eigen::MatrixXd root = scale.cwiseInverse().asDiagonal() * inverse;
  covariance.setZero();
  covariance(free, free) =
      squares / static_cast<double>(n - p) * root * root.transpose();
  return covariance;
}

}  // namespace palpate
