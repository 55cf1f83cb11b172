#include "fitting/numerics/autoregression.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double kReflectionMax = 1.0 - 1e-9;  // 1: foretold without any error

// Order that foretells sample i.
std::size_t order_at(const Autoregression& noise, Eigen::Index i) {
  return static_cast<std::size_t>(std::min(i, noise.order()));
}

}  // namespace

double Autoregression::long_run_variance() const {
  const double rest = 1.0 - coefficients.back().sum();
  return surprise.back() / (rest * rest);
}

Autoregression autoregression_of(const Eigen::VectorXd& residual,
                                 Eigen::Index order_max) {
  const auto n = residual.size();
  const double bic_of_one = std::log(static_cast<double>(n));
  Autoregression all;
  all.coefficients.emplace_back();
  // Errors of foretelling each sample from those before it, and from those after.
  Eigen::VectorXd ahead = residual, back = residual;
  Eigen::Index best = 0;
  double least = 0.0;
  for (Eigen::Index k = 1; k <= order_max; ++k) {
    const auto f = ahead.tail(n - k), b = back.segment(k - 1, n - k);
    const double both = f.squaredNorm() + b.squaredNorm();
    if (!(both > 0.0)) {
      break;
    }
    const double reflection =
        std::clamp(2.0 * f.dot(b) / both, -kReflectionMax, kReflectionMax);
    const Eigen::VectorXd next_f = f - reflection * b, next_b = b - reflection * f;
    ahead.tail(n - k) = next_f;
    back.tail(n - k) = next_b;
    const Eigen::VectorXd& before = all.coefficients.back();
    Eigen::VectorXd a(k);
    a.head(k - 1) = before - reflection * before.reverse();
    a[k - 1] = reflection;
    all.coefficients.push_back(std::move(a));
    all.surprise.push_back(all.surprise.back() * (1.0 - reflection * reflection));
    const double bic = static_cast<double>(n) * std::log(all.surprise.back()) +
                       static_cast<double>(k) * bic_of_one;
    if (bic < least) {
      least = bic;
      best = k;
    }
  }
  all.coefficients.resize(static_cast<std::size_t>(best) + 1);
  all.surprise.resize(static_cast<std::size_t>(best) + 1);
  return all;
}

double whiten(const Autoregression& noise, Eigen::MatrixXd& X) {
  double log_det = 0.0;
  for (Eigen::Index i = X.cols() - 1; i >= 0;
       --i) {  // those before are needed as they are
    const std::size_t order = order_at(noise, i);
    const Eigen::VectorXd& a = noise.coefficients[order];
    for (Eigen::Index j = 0; j < a.size(); ++j) {
      X.col(i) -= a[j] * X.col(i - 1 - j);
    }
    X.col(i) /= std::sqrt(noise.surprise[order]);
    log_det += std::log(noise.surprise[order]);
  }
  return log_det;
}

// With W x = e, V = W^-1 D W^-T: backwards by the columns of W^T, forwards by its rows.
Eigen::MatrixXd times_covariance(const Autoregression& noise, Eigen::MatrixXd X) {
  for (Eigen::Index i = X.rows() - 1; i >= 0; --i) {
    const std::size_t order = order_at(noise, i);
    const Eigen::VectorXd& a = noise.coefficients[order];
    for (Eigen::Index j = 0; j < a.size(); ++j) {
      X.row(i - 1 - j) += a[j] * X.row(i);
    }
    X.row(i) *= noise.surprise[order];
  }
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    const Eigen::VectorXd& a = noise.coefficients[order_at(noise, i)];
    for (Eigen::Index j = 0; j < a.size(); ++j) {
      X.row(i) += a[j] * X.row(i - 1 - j);
    }
  }
  return X;
}

}  // namespace palpate
