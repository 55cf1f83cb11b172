#include "fitting/numerics/least_squares.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/QR>
#include <ceres/ceres.h>
#include <glog/logging.h>

#include "fitting/numerics/correlated_noise.h"

namespace palpate {
namespace {

std::vector<int> free_parameters(const LeastSquaresProblem& problem, Eigen::Index p) {
  std::vector<int> free;
  for (int j = 0; j < p; ++j) {
    if (problem.held.empty() || !problem.held[static_cast<std::size_t>(j)]) {
      free.push_back(j);
    }
  }
  return free;
}

// All residuals as one block over the free parameters. The loss is folded into the
// residuals, sign(r) sqrt(rho(r^2)): the same cost, and one call per iteration.
class DenseBlock : public ceres::CostFunction {
 public:
  DenseBlock(const LeastSquaresProblem& problem, Eigen::VectorXd q,
             std::vector<int> free, double loss_scale)
      : problem_(problem),
        free_(std::move(free)),
        loss_scale_(loss_scale),
        q_(std::move(q)),
        jacobian_(problem.residuals, q_.size()) {
    set_num_residuals(problem.residuals);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(free_.size()));
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    for (std::size_t j = 0; j < free_.size(); ++j) {
      q_[free_[j]] = parameters[0][j];
    }
    Eigen::Map<Eigen::VectorXd> r(residuals, problem_.residuals);
    const bool derive = jacobians != nullptr && jacobians[0] != nullptr;
    if (!problem_.evaluate(q_, r, derive ? &jacobian_ : nullptr) || !r.allFinite()) {
      return false;
    }
    if (derive && !jacobian_.allFinite()) {
      return false;
    }
    const auto columns = static_cast<Eigen::Index>(free_.size());
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const double weight = robust(r[i]);
      for (Eigen::Index j = 0; derive && j < columns; ++j) {
        jacobians[0][i * columns + j] =
            weight * jacobian_(i, free_[static_cast<std::size_t>(j)]);
      }
    }
    return true;
  }

 private:
  // Replaces r and returns the derivative of the new one by the old.
  double robust(double& r) const {
    if (!(loss_scale_ > 0.0)) {
      return 1.0;
    }
    // rho(r^2) = s^2 ln(1 + r^2 / s^2), s = loss_scale. r becomes s sqrt(ln(1 + u^2)),
    // u = r/s, whose derivative is |u| / ((1 + u^2) sqrt(ln(1 + u^2))).
    const double u = r / loss_scale_;
    if (std::abs(u) < 1e-4) {
      return 1.0;  // equal to second order
    }
    const double g = std::sqrt(std::log1p(u * u));
    r = std::copysign(loss_scale_ * g, u);
    return std::abs(u) / ((1.0 + u * u) * g);
  }

  const LeastSquaresProblem& problem_;
  std::vector<int> free_;
  double loss_scale_;
  mutable Eigen::VectorXd q_;
  mutable RowMajorMatrix jacobian_;
};

// None where residuals or derivatives are no numbers.
std::optional<double> cost_at(const DenseBlock& block, const Eigen::VectorXd& q) {
  Eigen::VectorXd r(block.num_residuals());
  RowMajorMatrix jacobian(r.size(), q.size());
  const double* at = q.data();
  double* derivatives = jacobian.data();
  return block.Evaluate(&at, r.data(), &derivatives)
             ? std::optional(0.5 * r.squaredNorm())
             : std::nullopt;
}

ceres::Solver::Options solver_options(const LeastSquaresOptions& options) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations = options.iterations_max;
  solver.function_tolerance = options.tolerance;
  solver.gradient_tolerance = 1e-2 * options.tolerance;
  solver.parameter_tolerance = std::max(1e-13, 1e-1 * options.tolerance);
  solver.max_num_consecutive_invalid_steps = 20;
  solver.logging_type = ceres::SILENT;
  return solver;
}

// Ceres logs steps that it cannot take to stderr, whatever its options; its report
// tells of them. The level is the process's: nothing else here logs by glog.
void silence_log() {
  [[maybe_unused]] static const int level = FLAGS_minloglevel =
      std::max<int>(FLAGS_minloglevel, google::GLOG_FATAL);
}

thread_local SolverSeconds spent;

}  // namespace

SolverSeconds solver_seconds() noexcept {
  return spent;
}

LeastSquaresReport solve_least_squares(const LeastSquaresProblem& problem,
                                       const Eigen::VectorXd& start,
                                       const LeastSquaresOptions& options) {
  LeastSquaresReport report;
  report.q = start;
  if (problem.lower.size() > 0) {
    report.q = report.q.cwiseMax(problem.lower).cwiseMin(problem.upper);
  }
  const std::vector<int> free = free_parameters(problem, start.size());
  Eigen::VectorXd values = report.q(free);
  DenseBlock block(problem, report.q, free, options.loss_scale);
  // A start whose residuals or derivatives are no numbers does not converge; Ceres is
  // not called.
  const auto cost = cost_at(block, values);
  if (!cost || free.empty()) {
    report.converged = cost.has_value();
    report.cost = cost.value_or(kInf);
    return report;
  }
  // The block is on the stack: the problem must not delete it.
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem ceres_problem(ownership);
  ceres_problem.AddResidualBlock(&block, nullptr, values.data());
  for (int j = 0; problem.lower.size() > 0 && j < values.size(); ++j) {
    const int k = free[static_cast<std::size_t>(j)];
    if (std::isfinite(problem.lower[k])) {
      ceres_problem.SetParameterLowerBound(values.data(), j, problem.lower[k]);
    }
    if (std::isfinite(problem.upper[k])) {
      ceres_problem.SetParameterUpperBound(values.data(), j, problem.upper[k]);
    }
  }
  silence_log();
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(options), &ceres_problem, &summary);
  spent.total += summary.total_time_in_seconds;
  spent.evaluations += summary.residual_evaluation_time_in_seconds +
                       summary.jacobian_evaluation_time_in_seconds;
  report.q(free) = values;
  report.cost = summary.termination_type == ceres::FAILURE
                    ? std::numeric_limits<double>::infinity()
                    : summary.final_cost;
  report.iterations = static_cast<int>(summary.iterations.size());
  report.converged = summary.termination_type == ceres::CONVERGENCE;
  return report;
}

LeastSquaresReport solve_from_starts(const LeastSquaresProblem& problem,
                                     const std::vector<Eigen::VectorXd>& starts,
                                     const LeastSquaresOptions& options) {
  LeastSquaresReport best;
  int iterations = 0;
  for (const Eigen::VectorXd& start : starts) {
    LeastSquaresReport report = solve_least_squares(problem, start, options);
    iterations += report.iterations;
    if (report.cost < best.cost || best.q.size() == 0) {
      best = std::move(report);
    }
  }
  best.iterations = iterations;
  return best;
}

std::vector<bool> at_bound(const LeastSquaresProblem& problem,
                           const Eigen::VectorXd& q) {
  std::vector<bool> at(static_cast<std::size_t>(q.size()), false);
  for (Eigen::Index j = 0; problem.lower.size() > 0 && j < q.size(); ++j) {
    const double close = 1e-9 * std::max(1.0, std::abs(q[j]));
    at[static_cast<std::size_t>(j)] =
        q[j] <= problem.lower[j] + close || q[j] >= problem.upper[j] - close;
  }
  return at;
}

Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& jacobian, double sum_of_squares) {
  const Eigen::Index n = jacobian.rows(), p = jacobian.cols();
  Eigen::MatrixXd covariance =
      Eigen::MatrixXd::Constant(p, p, std::numeric_limits<double>::quiet_NaN());
  const Eigen::VectorXd scale = jacobian.colwise().norm();
  if (p == 0 || n <= p || !(scale.minCoeff() > 0.0)) {
    return covariance;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(jacobian *
                                                 scale.cwiseInverse().asDiagonal());
  qr.setThreshold(1e-10);
  if (qr.rank() < p) {
    return covariance;
  }
  // S (J^T J)^-1 / (n - p), S the squares. By Q R = J D^-1 P, D the columns' norms, the
  // inverse is root root^T with root = D^-1 P R^-1.
  const Eigen::MatrixXd inverse =
      qr.colsPermutation() *
      Eigen::MatrixXd(qr.matrixR()
                          .topLeftCorner(p, p)
                          .template triangularView<Eigen::Upper>()
                          .solve(Eigen::MatrixXd::Identity(p, p)));
  const Eigen::MatrixXd root = scale.cwiseInverse().asDiagonal() * inverse;
  return sum_of_squares / static_cast<double>(n - p) * root * root.transpose();
}

Eigen::MatrixXd least_squares_covariance(const LeastSquaresProblem& problem,
                                         const Eigen::VectorXd& q, SharedNoise kinds) {
  // Parameters that are held or stand at a bound are taken as known: their rows are
  // zero.
  const std::vector<bool> bound = at_bound(problem, q);
  std::vector<int> free;
  for (const int j : free_parameters(problem, q.size())) {
    if (!bound[static_cast<std::size_t>(j)]) {
      free.push_back(j);
    }
  }
  RowMajorMatrix jacobian(problem.residuals, q.size());
  Eigen::VectorXd r(problem.residuals);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(
      q.size(), q.size(), std::numeric_limits<double>::quiet_NaN());
  if (!problem.evaluate(q, r, &jacobian)) {
    return covariance;
  }
  const Eigen::MatrixXd J = jacobian(Eigen::all, free);
  const Eigen::MatrixXd of_free =
      problem.in_a_row > 0 ? covariance_under_noise(J, r, problem.in_a_row, kinds)
                           : covariance_of(J, r.squaredNorm());
  if (of_free.allFinite()) {
    covariance.setZero();
    covariance(free, free) = of_free;
  }
  return covariance;
}

}  // namespace palpate
