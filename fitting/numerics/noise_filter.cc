#include "fitting/numerics/noise_filter.h"

#include <cmath>

namespace palpate {
namespace {

constexpr double kSettled = 1e-13;  // of a variance from sample to sample

// Of smooth noise, (1 + l k) exp(-l k) over k samples.
double decay(const CorrelatedNoise& noise) {
  return -std::sqrt(3.0) * std::log(noise.rho);
}

// Kalman's filter of what neighbours share: what is expected of the next sample, and
// its variance, which soon settles. Samples are columns, so that each lies in a piece.
class RoughFilter {
 public:
  RoughFilter(const CorrelatedNoise& noise, Eigen::Index values)
      : rho_(noise.rho),
        shared_(noise.shared * noise.shared),
        white_(noise.white * noise.white),
        variance_(shared_),
        state_(Eigen::VectorXd::Zero(values)) {}

  [[nodiscard]] double variance() const { return variance_ + white_; }
  [[nodiscard]] const Eigen::VectorXd& expected() const { return state_; }
  void predict(const Eigen::Ref<const Eigen::VectorXd>& surprise) {
    state_ += gain() * surprise;
    state_ *= rho_;
  }
  // Whether the variance no longer changes.
  bool settle() {
    // Variance before the next sample: rho^2 P (1 - K) + (1 - rho^2) shared, gain K.
    const double before = variance_;
    variance_ =
        rho_ * rho_ * variance_ * (1.0 - gain()) + (1.0 - rho_ * rho_) * shared_;
    return std::abs(variance_ - before) <= kSettled * before;
  }

 private:
  [[nodiscard]] double gain() const { return variance_ / (variance_ + white_); }

  double rho_, shared_, white_, variance_;
  Eigen::VectorXd state_;
};

// Of smooth noise, whose state is its value and slope.
class SmoothFilter {
 public:
  SmoothFilter(const CorrelatedNoise& noise, Eigen::Index values)
      : white_(noise.white * noise.white),
        value_(Eigen::VectorXd::Zero(values)),
        slope_(value_) {
    // State (value, slope) of x'' + 2 l x' + l^2 x = white noise, over one sample. Its
    // variance is that of rest, diag(s, l^2 s); `fresh_` is what one sample adds.
    const double l = decay(noise), shared = noise.shared * noise.shared;
    A_ << 1.0 + l, 1.0, -l * l, 1.0 - l;
    A_ *= std::exp(-l);
    P_ = Eigen::Vector2d(shared, l * l * shared).asDiagonal();
    fresh_ = P_ - A_ * P_ * A_.transpose();
  }

  [[nodiscard]] double variance() const { return P_(0, 0) + white_; }
  [[nodiscard]] const Eigen::VectorXd& expected() const { return value_; }
  void predict(const Eigen::Ref<const Eigen::VectorXd>& surprise) {
    const Eigen::Vector2d gain = P_.col(0) / variance();
    value_ += gain[0] * surprise;
    slope_ += gain[1] * surprise;
    for (Eigen::Index k = 0; k < value_.size(); ++k) {
      const double value = value_[k], slope = slope_[k];
      value_[k] = A_(0, 0) * value + A_(0, 1) * slope;
      slope_[k] = A_(1, 0) * value + A_(1, 1) * slope;
    }
  }
  bool settle() {
    const Eigen::Vector2d gain = P_.col(0) / variance();
    const Eigen::Matrix2d before = P_;
    P_ = A_ * (P_ - gain * P_.row(0)) * A_.transpose() + fresh_;
    return (P_ - before).cwiseAbs().maxCoeff() <=
           kSettled * before.cwiseAbs().maxCoeff();
  }

 private:
  double white_;
  Eigen::Matrix2d A_, P_, fresh_;
  Eigen::VectorXd value_, slope_;
};

// L^-1 X for V = L L^T, sample by sample, and log det V.
// @param X (k x n), a column a sample
template <typename Filter>
double filtered(Filter&& filter, Eigen::MatrixXd& X) {
  double log_det = 0.0, log_variance = 0.0, root = 0.0;
  bool settled = false;
  for (Eigen::Index i = 0; i < X.cols(); ++i) {
    if (!settled) {
      const double variance = filter.variance();
      log_variance = std::log(variance);
      root = 1.0 / std::sqrt(variance);
    }
    log_det += log_variance;
    X.col(i) -= filter.expected();  // the surprise
    filter.predict(X.col(i));
    settled = settled || filter.settle();
    X.col(i) *= root;
  }
  return log_det;
}

// Sums over the samples before, and after, by recursion.
void add_smooth(const CorrelatedNoise& noise, const Eigen::MatrixXd& X,
                Eigen::MatrixXd& product) {
  const double shared = noise.shared * noise.shared, l = decay(noise);
  const double a = std::exp(-l);
  Eigen::RowVectorXd b = Eigen::RowVectorXd::Zero(X.cols()), bk = b, c = b, ck = b;
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    bk = a * (bk + b);  // sum of k a^k x
    b = a * b + X.row(i);
    product.row(i) += shared * (b + l * bk);
    const Eigen::Index j = X.rows() - 1 - i;
    product.row(j) += shared * (c + l * ck);
    ck = a * (ck + c + X.row(j));
    c = a * (c + X.row(j));
  }
}

}  // namespace

double CorrelatedNoise::long_run_variance() const {
  if (regression) {
    return shared * shared * regression->long_run_variance();
  }
  double times = (1.0 + rho) / (1.0 - rho);
  if (smooth) {
    const double l = decay(*this), a = std::exp(-l), rest = 1.0 - a;
    times = 1.0 + 2.0 * a / rest + 2.0 * l * a / (rest * rest);
  }
  return white * white + shared * shared * times;
}

double whiten(const CorrelatedNoise& noise, Eigen::MatrixXd& X) {
  if (noise.regression) {
    const double log_det = whiten(*noise.regression, X);
    X /= noise.shared;
    return log_det + 2.0 * static_cast<double>(X.cols()) * std::log(noise.shared);
  }
  return noise.smooth ? filtered(SmoothFilter(noise, X.rows()), X)
                      : filtered(RoughFilter(noise, X.rows()), X);
}

double weighed_squares(const CorrelatedNoise& noise, const Eigen::VectorXd& residual) {
  Eigen::MatrixXd white = residual.transpose();
  (void)whiten(noise, white);
  return white.squaredNorm();
}

Eigen::MatrixXd times_covariance(const CorrelatedNoise& noise,
                                 const Eigen::MatrixXd& X) {
  const double shared = noise.shared * noise.shared;
  if (noise.regression) {
    return shared * times_covariance(*noise.regression, X);
  }
  Eigen::MatrixXd product = noise.white * noise.white * X;
  if (noise.smooth) {
    add_smooth(noise, X, product);
    return product;
  }
  // sum_j shared rho^|i - j| x_j, from below by `before` and from above by `after`.
  Eigen::RowVectorXd before = Eigen::RowVectorXd::Zero(X.cols());
  Eigen::RowVectorXd after = before;
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    before = noise.rho * before + X.row(i);
    product.row(i) += shared * before;
    const Eigen::Index j = X.rows() - 1 - i;
    product.row(j) += shared * noise.rho * after;
    after = noise.rho * after + X.row(j);
  }
  return product;
}

}  // namespace palpate
