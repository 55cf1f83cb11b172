// What a joint fit says of one quantity: value, standard deviation, 95 % interval.
#pragma once

#include <functional>
#include <limits>
#include <string>

#include <Eigen/Core>

namespace palpate {

struct IntervalEstimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double sd = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN();  ///< of the 95 % interval
  double high = std::numeric_limits<double>::quiet_NaN();
  std::string refused = {};  ///< why there is none; empty where there is one
  double above = std::numeric_limits<double>::quiet_NaN();  ///< of a refused one: a
                                                            ///< lower bound; NaN: none
};

/// @param above lower bound; NaN: none is known.
[[nodiscard]] IntervalEstimate refused_estimate(
    const std::string& why, double above = std::numeric_limits<double>::quiet_NaN());

/// h such that |N + U| <= h with a probability of 95 %: N normal with the standard
/// deviation sd, U even over [-half, half]. Both at least 0.
[[nodiscard]] double half_interval_95(double sd, double half);

/// Of a function of the parameters: its derivatives by central differences over a
/// hundredth of a standard deviation, its variance to first order. Refused where the
/// covariance is not finite.
/// @param covariance (p x p). @param half half of the gap between samples in which an
/// event lies, in units of the quantity.
[[nodiscard]] IntervalEstimate estimate(
    const std::function<double(const Eigen::VectorXd&)>& quantity,
    const Eigen::VectorXd& q, const Eigen::MatrixXd& covariance, double half = 0.0);

/// The same of a positive quantity whose logarithm is given: its interval is that of
/// the logarithm.
[[nodiscard]] IntervalEstimate estimate_of_log(
    const std::function<double(const Eigen::VectorXd&)>& log_quantity,
    const Eigen::VectorXd& q, const Eigen::MatrixXd& covariance);

}  // namespace palpate
