// Samples in a row of which each follows from those before it,
//
//   x_i = a_1 x_(i-1) + ... + a_p x_(i-p) + e_i,   e white,
//
// of variance 1 in all: interference, vibration, a filter whose neighbours differ.
// Coefficients by Burg's recursion (1975), stable for any samples; the order by BIC.
// The first p samples are foretold by the lower orders, so that the likelihood is
// exact.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace palpate {

struct Autoregression {
  /// of orders 0..p: (k), nearest first
  std::vector<Eigen::VectorXd> coefficients{Eigen::VectorXd()};
  std::vector<double> surprise{1.0};  ///< [-] variance of e, of orders 0..p

  [[nodiscard]] Eigen::Index order() const { return std::ssize(surprise) - 1; }
  /// Variance of a mean of many samples, times their number.
  [[nodiscard]] double long_run_variance() const;
};

/// @param residual (n), not all zero. @param order_max less than n.
[[nodiscard]] Autoregression autoregression_of(const Eigen::VectorXd& residual,
                                               Eigen::Index order_max);

/// The autoregression of noise whose residuals, of a fit with this Jacobian (n x p),
/// follow `seen`. With H = J (J^T J)^-1 J^T a fit takes V - (I - H) V (I - H) off the
/// covariance V, most of it slow. To first order, V of `seen` there; of the same order.
/// `seen` where the first order is not enough: what it gives is no covariance, or half
/// as much again.
[[nodiscard]] Autoregression before_fit(const Autoregression& seen,
                                        const Eigen::MatrixXd& jacobian);

/// X L^-T for V = L L^T, sample by sample. @param X (k x n), a column a sample
/// @return log det V
double whiten(const Autoregression& noise, Eigen::MatrixXd& X);

/// V X, (n x k) like X.
[[nodiscard]] Eigen::MatrixXd times_covariance(const Autoregression& noise,
                                               Eigen::MatrixXd X);

}  // namespace palpate
