// Noise of samples in a row, white and shared by neighbours, and what it makes of a
// least-squares fit.
//
//   V(i, j) = white^2 [i = j] + shared^2 rho^|i - j|
//
// or, of smooth noise, shared^2 (1 + l k) exp(-l k), k = |i - j|, l = -sqrt(3) ln rho
// (Matern's of smoothness 3/2): what a law misses of a curve is smooth.
//
// The likelihood of a noise is the restricted one (Patterson and Thompson 1971):
// residuals of a fit are smaller than the noise, and less alike, by what the fit has
// followed of it. Few samples allow many noises, white or shared; what they make of a
// fit is the mean over all, weighted by likelihood: as probable as each other before
// are white noise and shared noise, and of that all shares and all logarithms of its
// length up to a quarter of the samples.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace palpate {

struct CorrelatedNoise {
  double white = 0.0;   ///< standard deviation, in units of the residuals
  double shared = 0.0;  ///< standard deviation of what neighbours share
  double rho = 0.0;     ///< [-] [0, 1) share of it that the next sample has still
  bool smooth = false;  ///< what is shared is smooth, and rho only tells its length

  /// Variance of a mean of many samples, times their number.
  [[nodiscard]] double long_run_variance() const;
};

struct ProbableNoise {
  CorrelatedNoise noise;
  double weight = 1.0;  ///< [-] sum 1 over all
};

/// Which noises are tried. A smooth shape that a law has not counts as noise where it
/// is known to be there; where it is not, trying it only widens intervals.
enum class SharedNoise { kRough, kAlsoSmooth };

/// Those that residuals allow, weights below 1e-3 left out.
/// @param jacobian (n x p) of the fit's free parameters; p may be 0.
/// @param residual (n) in the samples' order. White noise alone where n < p + 20.
/// @param longest [samples] at least 1, over which neighbours may share; 0: n / 4.
[[nodiscard]] std::vector<ProbableNoise> noises_of(
    const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
    SharedNoise kinds = SharedNoise::kRough, double longest = 0.0);

/// The mean of their long-run variances.
[[nodiscard]] double long_run_variance(const std::vector<ProbableNoise>& noises);

/// Number of independent samples among n residuals whose neighbours correlate by
/// rho > 2 / sqrt(n): n (1 - rho) / (1 + rho). Quick, and for few samples steadier than
/// noises_of().
[[nodiscard]] double effective_samples(std::span<const double> residuals);

/// r^T V^-1 r. @param residual (n) in the samples' order. @param noise not zero.
[[nodiscard]] double weighed_squares(const CorrelatedNoise& noise,
                                     const Eigen::VectorXd& residual);

/// V X, (n x k) like X.
[[nodiscard]] Eigen::MatrixXd times_covariance(const CorrelatedNoise& noise,
                                               const Eigen::MatrixXd& X);

/// Covariance of plain least-squares parameters under the noise of their residuals:
/// (J^T J)^-1 J^T V J (J^T J)^-1. All NaN where they cannot be told apart.
/// @param jacobian, residual as for noises_of(). @param samples how many of the first
/// rows are samples in a row; the others are expectations, each with an error of its
/// own as large as a sample's. @param kinds as noises_of().
[[nodiscard]] Eigen::MatrixXd covariance_under_noise(
    const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
    Eigen::Index samples, SharedNoise kinds = SharedNoise::kRough);

}  // namespace palpate
