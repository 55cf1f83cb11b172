#include "fitting/numerics/autoregression.h"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

namespace palpate {
namespace {

constexpr double kReflectionMax = 1.0 - 1e-9;  // 1: foretold without any error
constexpr double kTakenMax = 1.5;              // variance before over after a fit

// Order that foretells sample i.
std::size_t order_at(const Autoregression& noise, Eigen::Index i) {
  return static_cast<std::size_t>(std::min(i, noise.order()));
}

// One order more (Levinson).
void add_order(double reflection, Autoregression& noise) {
  const Eigen::VectorXd& before = noise.coefficients.back();
  const Eigen::Index k = before.size() + 1;
  Eigen::VectorXd a(k);
  a.head(k - 1) = before - reflection * before.reverse();
  a[k - 1] = reflection;
  noise.coefficients.push_back(std::move(a));
  noise.surprise.push_back(noise.surprise.back() * (1.0 - reflection * reflection));
}

// Over 0..p samples, by Yule and Walker.
Eigen::VectorXd autocorrelation_of(const Autoregression& noise) {
  Eigen::VectorXd gamma(noise.order() + 1);
  gamma[0] = 1.0;
  for (Eigen::Index k = 1; k < gamma.size(); ++k) {
    gamma[k] =
        noise.coefficients[static_cast<std::size_t>(k)].dot(gamma.head(k).reverse());
  }
  return gamma;
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
    // Burg's reflection: 2 f . b / (|f|^2 + |b|^2), which keeps the noise stationary.
    const double reflection =
        std::clamp(2.0 * f.dot(b) / both, -kReflectionMax, kReflectionMax);
    const Eigen::VectorXd next_f = f - reflection * b, next_b = b - reflection * f;
    ahead.tail(n - k) = next_f;
    back.tail(n - k) = next_b;
    add_order(reflection, all);
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

Autoregression before_fit(const Autoregression& seen, const Eigen::MatrixXd& jacobian) {
  const Eigen::Index n = jacobian.rows(), order = seen.order();
  if (jacobian.cols() == 0 || order == 0) {
    return seen;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(jacobian);
  const Eigen::MatrixXd Q =  // H = Q Q^T
      qr.householderQ() * Eigen::MatrixXd::Identity(n, qr.rank());
  const Eigen::MatrixXd VQ = times_covariance(seen, Q);
  const Eigen::MatrixXd QQVQ = Q * (Q.transpose() * VQ);
  Eigen::VectorXd gamma = autocorrelation_of(seen);
  for (Eigen::Index k = 0; k <= order; ++k) {
    // of H V + V H - H V H, its mean k samples off the diagonal
    const Eigen::Index m = n - k;
    const auto before = Q.topRows(m), after = Q.bottomRows(m);
    gamma[k] += (before.cwiseProduct(VQ.bottomRows(m)) +
                 (VQ - QQVQ).topRows(m).cwiseProduct(after))
                    .sum() /
                static_cast<double>(m);
  }
  if (gamma[0] > kTakenMax) {
    return seen;
  }
  gamma /= gamma[0];
  Autoregression noise;
  for (Eigen::Index k = 1; k <= order; ++k) {
    const double foretold =
        noise.coefficients.back().dot(gamma.segment(1, k - 1).reverse());
    const double reflection = (gamma[k] - foretold) / noise.surprise.back();
    if (!(std::abs(reflection) < kReflectionMax)) {
      return seen;
    }
    add_order(reflection, noise);
  }
  return noise;
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
