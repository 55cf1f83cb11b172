#include "fitting/numerics/correlated_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "fitting/numerics/least_squares.h"
#include "fitting/numerics/nelder_mead.h"

namespace palpate {
namespace {

constexpr Eigen::Index kNoiseRowsMax = 4000;
// Noises that are tried: shares of all that neighbours share, and lengths [samples].
constexpr std::array<double, 6> kShares{0.03, 0.12, 0.3, 0.6, 0.9, 1.0};
constexpr double kShortest = 0.5, kShortestSmooth = 2.0;
constexpr double kLongestPerSample = 0.25;
constexpr int kLengths = 12;
constexpr Eigen::Index kLeftMin = 20;  // fewer tell nothing of what they share
constexpr double kNoiseWeightMin = 1e-3;
constexpr double kSettled = 1e-13;  // of a variance from sample to sample
constexpr double kSizeMin = 1e-3;   // of residuals near a sample, of that of all
constexpr double kSure = 0.5;       // the grid is coarser than what samples tell

double squashed(double x) {
  return 1.0 / (1.0 + std::exp(-x));
}
double unsquashed(double share) {
  return std::log(share / (1.0 - share));
}

// Of variance 1 in all.
CorrelatedNoise unit_noise(double share, double rho, bool smooth = false) {
  return {std::sqrt(1.0 - share), std::sqrt(share), rho, smooth};
}

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

double whiten(const CorrelatedNoise& noise, Eigen::MatrixXd& X) {
  return noise.smooth ? filtered(SmoothFilter(noise, X.rows()), X)
                      : filtered(RoughFilter(noise, X.rows()), X);
}

struct Tried {
  CorrelatedNoise noise;
  double cost = 0.0;  // twice the negative logarithm of the restricted likelihood
};

// Of noises of variance 1, their scale at its best.
class Restricted {
 public:
  Restricted(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual)
      : both_(jacobian.cols() + 1, jacobian.rows()) {
    const Eigen::VectorXd scale =
        jacobian.colwise().norm().cwiseMax(std::numeric_limits<double>::min());
    both_ << (jacobian * scale.cwiseInverse().asDiagonal()).transpose(),
        residual.transpose();
  }

  [[nodiscard]] Tried at(const CorrelatedNoise& unit) const {
    Eigen::MatrixXd X = both_;
    const double log_det = whiten(unit, X);
    const Eigen::Index p = X.rows() - 1;
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(p + 1, p + 1);
    products.selfadjointView<Eigen::Lower>().rankUpdate(X);
    const Eigen::LDLT<Eigen::MatrixXd> normal(products.topLeftCorner(p, p));
    const Eigen::VectorXd target = products.row(p).head(p);
    const auto left = static_cast<double>(X.cols() - p);
    const double least = std::numeric_limits<double>::min();
    const double squares =
        std::max(products(p, p) - target.dot(normal.solve(target)), least);
    const double sd = std::sqrt(squares / left);
    return {{sd * unit.white, sd * unit.shared, unit.rho, unit.smooth},
            left * std::log(squares) + log_det +
                normal.vectorD().array().max(least).log().sum()};
  }

 private:
  Eigen::MatrixXd both_;  // (p + 1 x n) of J, r
};

// White noise, the first, is as probable before as all others together.
std::vector<ProbableNoise> weighed(const std::vector<Tried>& tried) {
  const auto least =
      std::min_element(tried.begin(), tried.end(), [](const Tried& a, const Tried& b) {
        return a.cost < b.cost;
      })->cost;
  std::vector<ProbableNoise> noises;
  double sum = 0.0;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    const double before = i == 0 ? static_cast<double>(tried.size() - 1) : 1.0;
    noises.push_back(
        {tried[i].noise, before * std::exp(0.5 * (least - tried[i].cost))});
    sum += noises.back().weight;
  }
  std::erase_if(noises, [&](const ProbableNoise& noise) {
    return noise.weight < kNoiseWeightMin * sum;
  });
  sum = 0.0;
  for (const ProbableNoise& noise : noises) {
    sum += noise.weight;
  }
  for (ProbableNoise& noise : noises) {
    noise.weight /= sum;
  }
  return noises;
}

// The most probable near one, of no greater length: what is shared by all samples no
// residual can tell.
CorrelatedNoise refined(const Restricted& likelihood, const CorrelatedNoise& start,
                        double longest) {
  const double rho_max = std::exp(-1.0 / longest);
  const auto noise_at = [&](const Eigen::VectorXd& q) {
    return unit_noise(squashed(q[0]), std::min(squashed(q[1]), rho_max), start.smooth);
  };
  const double white = start.white * start.white;
  const double shared = start.shared * start.shared;
  const Eigen::Vector2d q(unsquashed(std::min(shared / (white + shared), 0.99)),
                          unsquashed(start.rho));
  const SimplexReport best = minimise_simplex(
      [&](const Eigen::VectorXd& at) {
        return likelihood.at(noise_at(at)).cost;
      },
      q);
  return likelihood.at(noise_at(best.x)).noise;
}

// Means of as many neighbours as leave few enough rows: what is shared over a few
// samples of very many is white to the fit.
Eigen::MatrixXd averaged(const Eigen::MatrixXd& rows) {
  const Eigen::Index of = (rows.rows() + kNoiseRowsMax - 1) / kNoiseRowsMax;
  if (of <= 1) {
    return rows;
  }
  Eigen::MatrixXd means(rows.rows() / of, rows.cols());
  for (Eigen::Index i = 0; i < means.rows(); ++i) {
    means.row(i) = rows.middleRows(i * of, of).colwise().mean();
  }
  return means;
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

// Rms of the residuals near each sample, over a third of all of them.
Eigen::VectorXd local_size(const Eigen::VectorXd& r) {
  const Eigen::Index reach = r.size() / 6;
  Eigen::VectorXd size(r.size());
  const double all = r.norm() / std::sqrt(static_cast<double>(r.size()));
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const Eigen::Index begin = std::max<Eigen::Index>(0, i - reach);
    const Eigen::Index count = std::min(r.size(), i + reach + 1) - begin;
    size[i] = std::max(kSizeMin * all, r.segment(begin, count).norm() /
                                           std::sqrt(static_cast<double>(count)));
  }
  return size;
}

Eigen::MatrixXd not_a_number(Eigen::Index p) {
  return Eigen::MatrixXd::Constant(p, p, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

std::vector<ProbableNoise> noises_of(const Eigen::MatrixXd& jacobian,
                                     const Eigen::VectorXd& residual, SharedNoise kinds,
                                     double longest) {
  const Eigen::Index n = residual.size();
  const Eigen::Index left = n - jacobian.cols();
  if (left < kLeftMin || !(residual.squaredNorm() > 0.0)) {
    const auto degrees = static_cast<double>(std::max<Eigen::Index>(1, left));
    return {{{.white = std::sqrt(residual.squaredNorm() / degrees)}, 1.0}};
  }
  const Restricted likelihood(jacobian, residual);
  std::vector<Tried> tried{likelihood.at(unit_noise(0.0, 0.0))};
  if (!(longest >= 1.0)) {
    longest = std::max(1.0, kLongestPerSample * static_cast<double>(n));
  }
  for (int i = 0; i < kLengths; ++i) {
    const double length =
        kShortest * std::pow(longest / kShortest, i / (kLengths - 1.0));
    for (const double share : kShares) {
      tried.push_back(likelihood.at(unit_noise(share, std::exp(-1.0 / length))));
      if (kinds == SharedNoise::kAlsoSmooth && length > kShortestSmooth) {
        tried.push_back(
            likelihood.at(unit_noise(share, std::exp(-1.0 / length), true)));
      }
    }
  }
  std::vector<ProbableNoise> noises = weighed(tried);
  const auto best = std::max_element(
      noises.begin(), noises.end(), [](const ProbableNoise& a, const ProbableNoise& b) {
        return a.weight < b.weight;
      });
  if (best->weight > kSure && best->noise.shared > 0.0) {
    return {{refined(likelihood, best->noise, longest), 1.0}};
  }
  return noises;
}

double effective_samples(std::span<const double> residuals) {
  const std::size_t n = residuals.size();
  double squares = 0.0, products = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    squares += residuals[i] * residuals[i];
    products += i + 1 < n ? residuals[i] * residuals[i + 1] : 0.0;
  }
  const double rho = squares > 0.0 ? products / squares : 0.0;
  const auto count = static_cast<double>(n);
  return rho > 2.0 / std::sqrt(count) ? count * (1.0 - rho) / (1.0 + rho) : count;
}

double weighed_squares(const CorrelatedNoise& noise, const Eigen::VectorXd& residual) {
  Eigen::MatrixXd white = residual.transpose();
  (void)whiten(noise, white);
  return white.squaredNorm();
}

double CorrelatedNoise::long_run_variance() const {
  double times = (1.0 + rho) / (1.0 - rho);
  if (smooth) {
    const double l = decay(*this), a = std::exp(-l), rest = 1.0 - a;
    times = 1.0 + 2.0 * a / rest + 2.0 * l * a / (rest * rest);
  }
  return white * white + shared * shared * times;
}

double long_run_variance(const std::vector<ProbableNoise>& noises) {
  double mean = 0.0;
  for (const auto& [noise, weight] : noises) {
    mean += weight * noise.long_run_variance();
  }
  return mean;
}

Eigen::MatrixXd times_covariance(const CorrelatedNoise& noise,
                                 const Eigen::MatrixXd& X) {
  const double shared = noise.shared * noise.shared;
  Eigen::MatrixXd product = noise.white * noise.white * X;
  if (noise.smooth) {
    add_smooth(noise, X, product);
    return product;
  }
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

Eigen::MatrixXd covariance_under_noise(const Eigen::MatrixXd& jacobian,
                                       const Eigen::VectorXd& residual,
                                       Eigen::Index samples, SharedNoise kinds) {
  const Eigen::Index p = jacobian.cols();
  const Eigen::MatrixXd J = averaged(jacobian.topRows(samples));
  const double times = static_cast<double>(samples) / static_cast<double>(J.rows());
  const Eigen::MatrixXd expected =
      jacobian.bottomRows(jacobian.rows() - samples) / std::sqrt(times);
  Eigen::MatrixXd all(J.rows() + expected.rows(), p);
  all << J, expected;
  const Eigen::MatrixXd bread =  // (J^T J)^-1
      covariance_of(all, static_cast<double>(all.rows() - p));
  if (p == 0 || !bread.allFinite()) {
    return not_a_number(p);
  }
  Eigen::MatrixXd filling = Eigen::MatrixXd::Zero(p, p);
  Eigen::VectorXd r = averaged(residual.head(samples));
  const Eigen::VectorXd size = kinds == SharedNoise::kAlsoSmooth
                                   ? local_size(r)
                                   : Eigen::VectorXd::Ones(r.size());
  const Eigen::MatrixXd sized = size.asDiagonal() * J;
  for (const auto& [noise, weight] :
       noises_of(size.cwiseInverse().asDiagonal() * J, r.cwiseQuotient(size), kinds)) {
    const double variance = noise.white * noise.white + noise.shared * noise.shared;
    filling += weight * (sized.transpose() * times_covariance(noise, sized) +
                         variance * expected.transpose() * expected);
  }
  return bread * filling * bread;
}

}  // namespace palpate
