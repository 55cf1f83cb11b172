// Values at new places from values at known ones: ordinary kriging (Matheron 1963;
// Cressie, Statistics for Spatial Data, 1993, section 3.2). Kriging is the best linear
// unbiased prediction of a random field with constant but unknown mean. The covariance
// is Matern's with nu = 3/2: a field that is smooth, but not very.
//
// The field's spread is not needed here: variances are shares of the spread.
#pragma once

#include <Eigen/Core>

namespace palpate {

class Kriging {
 public:
  /// @param place (n x d), n >= 1: coordinates [-], in lengths over which values are
  /// alike. @throws NumericalError if one is not finite.
  explicit Kriging(Eigen::MatrixXd place);

  [[nodiscard]] Eigen::Index size() const { return place_.rows(); }

  struct Prediction {
    Eigen::VectorXd weight;  ///< (n) [-] of the known values; they sum up to 1
    double variance = 0.0;   ///< [-] of what it is off by
  };
  /// @param place (d) [-].
  [[nodiscard]] Prediction at(const Eigen::VectorXd& place) const;

  /// How far each known value is off what all others predict there (Dubrule 1983).
  /// @param value (n x m), m values at each place; n >= 2. Returns (n x m).
  [[nodiscard]] Eigen::MatrixXd left_out(const Eigen::MatrixXd& value) const;
  /// (n) [-] The variances of those.
  [[nodiscard]] Eigen::VectorXd left_out_variance() const;

 private:
  Eigen::MatrixXd place_;
  Eigen::MatrixXd inverse_;  // (n x n) of the covariance
  Eigen::VectorXd sum_;      // (n) of its rows
  // (n x n) inverse_ without the mean: applied to constants it is zero.
  Eigen::MatrixXd projected_;
};

}  // namespace palpate
