// Noise of samples in a row, white and shared by neighbours,
//
//   V(i, j) = white^2 [i = j] + shared^2 rho^|i - j|
//
// or, of smooth noise, shared^2 (1 + l k) exp(-l k), k = |i - j|, l = -sqrt(3) ln rho
// (Matern's of smoothness 3/2). What a law misses of a curve is smooth. What oscillates
// follows from the samples before (autoregression.h).
#pragma once

#include <memory>

#include <Eigen/Core>

#include "fitting/numerics/autoregression.h"

namespace palpate {

struct CorrelatedNoise {
  double white = 0.0;   ///< standard deviation, in units of the residuals
  double shared = 0.0;  ///< standard deviation of what neighbours share
  double rho = 0.0;     ///< [-] [0, 1) share of it that the next sample has still
  bool smooth = false;  ///< what is shared is smooth, and rho only tells its length
  /// All of what is shared, white and rho then 0; null: none
  std::shared_ptr<const Autoregression> regression = nullptr;

  [[nodiscard]] double variance() const { return white * white + shared * shared; }
  /// Variance of a mean of many samples, times their number.
  [[nodiscard]] double long_run_variance() const;
};

/// L^-1 X^T, transposed, for V = L L^T. @param X (k x n), a column a sample
/// @return log det V
double whiten(const CorrelatedNoise& noise, Eigen::MatrixXd& X);

/// r^T V^-1 r. @param residual (n) in the samples' order. @param noise not zero.
[[nodiscard]] double weighed_squares(const CorrelatedNoise& noise,
                                     const Eigen::VectorXd& residual);

/// V X, (n x k) like X.
[[nodiscard]] Eigen::MatrixXd times_covariance(const CorrelatedNoise& noise,
                                               const Eigen::MatrixXd& X);

}  // namespace palpate
