// Nonlinear least squares within bounds: Levenberg-Marquardt (Ceres) on one dense
// block.
//
//   minimise 1/2 sum_i rho(r_i(q)^2),  lower <= q <= upper
//
// rho is the identity, or Cauchy's loss s^2 ln(1 + r^2/s^2), which residuals far beyond
// the scale s hardly move.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fitting/numerics/correlated_noise.h"

namespace palpate {

using RowMajorMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The bound of a parameter that has none.
inline constexpr double kInf = std::numeric_limits<double>::infinity();

struct LeastSquaresProblem {
  int residuals = 0;
  /// Residuals (n) at q (p), and dr/dq (n x p) where it is not null; false where the
  /// model has no value.
  std::function<bool(const Eigen::VectorXd& q, Eigen::Ref<Eigen::VectorXd> r,
                     RowMajorMatrix* jacobian)>
      evaluate;
  Eigen::VectorXd lower, upper;  ///< (p); empty: unbounded. +-inf where there is none
  std::vector<bool> held;        ///< (p); empty: all are free
  /// So many of the first residuals are of samples in a row, whose noise may be shared
  /// by neighbours; the others are expectations. 0: all are independent.
  int in_a_row = 0;
};

struct LeastSquaresOptions {
  double loss_scale = 0.0;   ///< s in units of the residuals; 0: plain squares
  double tolerance = 1e-14;  ///< relative decrease of the cost at which it stops
  int iterations_max = 200;
};

struct LeastSquaresReport {
  Eigen::VectorXd q;  ///< (p)
  double cost = std::numeric_limits<double>::infinity();
  int iterations = 0;
  bool converged = false;
};

/// [s] that this thread has spent in Ceres so far, and of that in the problems' own
/// evaluations: for benchmarks.
struct SolverSeconds {
  double total = 0.0, evaluations = 0.0;
};
[[nodiscard]] SolverSeconds solver_seconds() noexcept;

/// Parameters are scaled by the columns of the Jacobian. Non-convergence is a result.
[[nodiscard]] LeastSquaresReport solve_least_squares(
    const LeastSquaresProblem& problem, const Eigen::VectorXd& start,
    const LeastSquaresOptions& options = {});

/// The best of several starts.
[[nodiscard]] LeastSquaresReport solve_from_starts(
    const LeastSquaresProblem& problem, const std::vector<Eigen::VectorXd>& starts,
    const LeastSquaresOptions& options = {});

/// Of the parameters at q, (p x p): (J^T J)^-1 sum of squares / (n - p), p the number
/// of free parameters. Else the covariance under the noise of samples in a row
/// (covariance_under_noise). Rows and columns of held ones, and of those at a bound,
/// are zero; all NaN where the free ones cannot be separated.
[[nodiscard]] Eigen::MatrixXd least_squares_covariance(
    const LeastSquaresProblem& problem, const Eigen::VectorXd& q,
    SharedNoise kinds = SharedNoise::kRough);

/// The same from J (n x p) of the free parameters alone.
[[nodiscard]] Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& jacobian,
                                            double sum_of_squares);

/// Whether a parameter stands at a bound, within 1e-9 of its size.
[[nodiscard]] std::vector<bool> at_bound(const LeastSquaresProblem& problem,
                                         const Eigen::VectorXd& q);

}  // namespace palpate
