// What the residuals of a fitted law say: noise, or a shape that the law has not.
//
// A cubic spline of up to kIntervals even shares of the samples follows the residuals.
// What the spline leaves is noise, white and shared by neighbours (correlated_noise.h).
// The restricted likelihood is used, so that what of the noise the spline has followed
// is counted. Q is the spline's orthonormal basis. Under that noise V the spline takes
// tr(Q^T V Q) of the residuals' squares, with variance 2 tr((Q^T V Q)^2). The law
// misses what the spline takes more, or what the residuals' mean square is above the
// noise's. A sharp miss shows by the residuals' mean square. What neighbours share over
// more than a spline's interval counts as shape, unless samples that surely touch
// nothing have it too.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "fitting/numerics/correlated_noise.h"

namespace palpate {

struct Misfit {
  double noise_sd = 0.0;  ///< of the noise in all, units of the residuals
  double long_run_sd =
      0.0;  ///< of a mean of many samples, times the root of their number
  double missed_rms = 0.0;  ///< of the shape that is missed, the noise taken out
  double deviations = 0.0;  ///< [-] standard deviations by which that is no noise
};

/// The shape may be there: 3 standard deviations, and a ten thousandth of the forces'
/// range.
[[nodiscard]] bool may_miss(const Misfit& misfit, double force_range);

/// The shape is there beyond doubt: 5 standard deviations, and a ten thousandth of the
/// forces' range.
[[nodiscard]] bool is_sure(const Misfit& misfit, double force_range);

/// It is sure, no smaller than the noise, and larger than a thousandth of the forces'
/// range.
[[nodiscard]] bool matters(const Misfit& misfit, double force_range);

/// The noise of samples in a row, found once from the residuals of the law that follows
/// them best, by which others are judged.
class ResidualNoise {
 public:
  /// @param x (n) displacements, any order. @param residual (n) in the samples' order.
  /// @param free so many of the first samples touch nothing. All that these samples are
  /// beside a straight line is noise, and the other samples' noise is the same. 0: none
  /// is known.
  ResidualNoise(std::span<const double> x, std::span<const double> residual,
                std::size_t free = 0);

  /// Of other residuals of the same samples (n).
  [[nodiscard]] Misfit misfit(std::span<const double> residual) const;

  /// -2 log of how much less likely other residuals of the same samples are, over all
  /// noises that these allow.
  [[nodiscard]] double deviance(std::span<const double> residual) const;

  [[nodiscard]] double noise_sd() const { return noise_sd_; }
  /// Independent samples that tell as much of a mean as these do, at most n: the mean
  /// over all noises that the residuals allow.
  [[nodiscard]] double independent_samples() const { return independent_; }

 private:
  [[nodiscard]] Eigen::VectorXd averaged(std::span<const double> values) const;

  Eigen::Index samples_ = 0, together_ = 1;  // n; neighbours in one row
  Eigen::MatrixXd Q_;                        // (rows x k) of the spline
  std::vector<ProbableNoise> noises_;        // of rows; white and shared not both zero
  std::vector<double> squares_;              // weighed_squares() of these residuals
  double expected_ = 0.0, expected_sd_ = 0.0;
  double noise_sd_ = 0.0, long_run_variance_ = 0.0, independent_ = 0.0;
};

/// Of the residuals by their own noise.
[[nodiscard]] Misfit find_misfit(std::span<const double> x,
                                 std::span<const double> residual);

}  // namespace palpate
