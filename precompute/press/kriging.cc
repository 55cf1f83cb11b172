#include "precompute/press/kriging.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/base/error.h"
#include "formats/base/reproducible.h"
#include "precompute/fem/dense_cholesky.h"

namespace palpate {
namespace {

// The variance of each value on its own: no two presses have the same mesh. It also
// keeps places that coincide from making the covariance singular.
constexpr double kNugget = 0.02 * 0.02;

double covariance(double distance) {
  // Matern, nu = 3/2: (1 + sqrt(3) d) exp(-sqrt(3) d).
  const double r = std::numbers::sqrt3 * distance;
  return (1.0 + r) * reproducible::exp(-r);
}

}  // namespace

Kriging::Kriging(Eigen::MatrixXd place) : place_(std::move(place)) {
  const Eigen::Index n = size();
  Eigen::MatrixXd among(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    among(j, j) = 1.0 + kNugget;
    for (Eigen::Index i = j + 1; i < n; ++i) {
      among(i, j) = covariance((place_.row(i) - place_.row(j)).norm());
    }
  }
  const DenseCholesky factor(std::move(among));
  if (!factor.is_definite()) {
    throw NumericalError("kriging: a place is not finite");
  }
  inverse_.resize(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    inverse_.col(j) = factor.solve(Eigen::VectorXd::Unit(n, j));
  }
  // s = C^-1 1, and P = C^-1 - s s^T / (1^T C^-1 1).
  sum_ = inverse_.rowwise().sum();
  projected_ = inverse_ - sum_ * (sum_ / sum_.sum()).transpose();
}

Kriging::Prediction Kriging::at(const Eigen::VectorXd& place) const {
  Eigen::VectorXd to(size());
  for (Eigen::Index i = 0; i < size(); ++i) {
    to[i] = covariance((place_.row(i).transpose() - place).norm());
  }
  // Weights C^-1 (c + lambda 1) with lambda = (1 - 1^T C^-1 c) / (1^T C^-1 1). Variance
  // 1 + nugget - c^T C^-1 c + (1 - 1^T C^-1 c)^2 / (1^T C^-1 1) (Cressie 1993, section
  // 3.2).
  Prediction prediction{.weight = inverse_ * to};
  const double lacking = 1.0 - prediction.weight.sum();  // the mean's share
  // In this order, so that what is not a number stays one.
  prediction.variance = std::max(
      1.0 + kNugget - to.dot(prediction.weight) + lacking * lacking / sum_.sum(), 0.0);
  prediction.weight += lacking / sum_.sum() * sum_;
  return prediction;
}

Eigen::MatrixXd Kriging::left_out(const Eigen::MatrixXd& value) const {
  // Value minus prediction by the others: (P z)_i / P_ii, of variance 1 / P_ii (Dubrule
  // 1983).
  Eigen::MatrixXd off(value.rows(), value.cols());
  for (Eigen::Index m = 0; m < value.cols(); ++m) {
    // By columns: products of matrices are blocked by the processor's caches.
    off.col(m).noalias() = projected_ * value.col(m);
    off.col(m).array() /= projected_.diagonal().array();
  }
  return off;
}

Eigen::VectorXd Kriging::left_out_variance() const {
  return projected_.diagonal().cwiseInverse();
}

}  // namespace palpate
