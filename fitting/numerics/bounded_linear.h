// Linear least squares in which some parameters must not be negative.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace palpate {

/// Minimises |A x - b|, x_j >= 0 where `not_negative`: active sets after Lawson and
/// Hanson (1974), on the normal matrix. (A: n x p; x: p)
[[nodiscard]] Eigen::VectorXd solve_not_negative(const Eigen::MatrixXd& A,
                                                 const Eigen::VectorXd& b,
                                                 const std::vector<bool>& not_negative);

/// The nearest rising sequence: weighted least squares by pooling adjacent violators.
/// (values, weights: n; weights > 0)
[[nodiscard]] std::vector<double> isotonic(const std::vector<double>& values,
                                           const std::vector<double>& weights);

}  // namespace palpate
