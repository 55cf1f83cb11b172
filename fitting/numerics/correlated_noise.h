// Noise of samples in a row (noise_filter.h) as residuals tell it, and what it makes of
// a least-squares fit.
//
// The likelihood of a noise is the restricted one (Patterson and Thompson 1971).
// Residuals of a fit are smaller than the noise, and less correlated, by what the fit
// has followed of the noise. Few samples allow many noises, white or shared. What these
// noises make of a fit is the mean over all, weighted by likelihood. White noise,
// shared noise and an autoregression are equally probable a priori. So are, of shared
// noise, all shares and all logarithms of its length up to a quarter of the samples.
// The autoregression is tried where BIC prefers an order of 2 or more, or neighbours
// that differ.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "fitting/numerics/noise_filter.h"

namespace palpate {

struct ProbableNoise {
  CorrelatedNoise noise;
  double weight = 1.0;  ///< [-] sum 1 over all
};

/// Which noises are tried beside white and rough ones. A smooth shape that a law has
/// not counts as noise where the shape is known to be there. Where the shape is not
/// there, trying it only widens intervals.
enum class SharedNoise { kRough, kAlsoSmooth, kAlsoRegression };

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

/// Covariance of plain least-squares parameters under the noise of their residuals:
/// (J^T J)^-1 J^T V J (J^T J)^-1. All NaN where they cannot be separated.
/// @param jacobian, residual as for noises_of(). @param samples how many of the first
/// rows are samples in a row. The others are expectations, each with an error of its
/// own as large as a sample's. @param kinds as noises_of(). With regressions, noise
/// whose slow part is the larger is found by means of neighbours, at most 200. By few
/// independent means the covariance is wider, so that 1.96 standard deviations hold
/// 95 %.
[[nodiscard]] Eigen::MatrixXd covariance_under_noise(
    const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
    Eigen::Index samples, SharedNoise kinds = SharedNoise::kRough);

}  // namespace palpate
