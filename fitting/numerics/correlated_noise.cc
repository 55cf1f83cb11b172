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

constexpr Eigen::Index kRowsMax = 4000;
// Noises that are tried: shares of all that neighbours share, and lengths [samples].
constexpr std::array<double, 6> kShares{0.03, 0.12, 0.3, 0.6, 0.9, 1.0};
constexpr double kShortest = 0.5;
constexpr double kLongestPerSample = 0.25;
constexpr int kLengths = 12;
constexpr Eigen::Index kLeftMin = 20;  // fewer tell nothing of what they share
constexpr double kWeightMin = 1e-3;
constexpr double kSure = 0.5;  // the grid is coarser than what samples tell

double squashed(double x) {
  return 1.0 / (1.0 + std::exp(-x));
}
double unsquashed(double share) {
  return std::log(share / (1.0 - share));
}

// Of variance 1 in all.
CorrelatedNoise unit_noise(double share, double rho) {
  return {std::sqrt(1.0 - share), std::sqrt(share), rho};
}

// L^-1 X for V = L L^T, row by row (Kalman's filter), and log det V.
double whiten(const CorrelatedNoise& noise, Eigen::MatrixXd& X) {
  const double white = noise.white * noise.white;
  const double shared = noise.shared * noise.shared;
  const double rho = noise.rho;
  Eigen::RowVectorXd expected = Eigen::RowVectorXd::Zero(X.cols());
  double variance = shared;  // of what is expected of the shared part
  double log_det = 0.0;
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    const double all = variance + white;
    const double gain = variance / all;
    const Eigen::RowVectorXd surprise = X.row(i) - expected;
    expected = rho * (expected + gain * surprise);
    variance = rho * rho * variance * (1.0 - gain) + (1.0 - rho * rho) * shared;
    X.row(i) = surprise / std::sqrt(all);
    log_det += std::log(all);
  }
  return log_det;
}

struct Tried {
  CorrelatedNoise noise;
  double cost = 0.0;  // twice the negative logarithm of the restricted likelihood
};

// Of noises of variance 1, their scale at its best.
class Restricted {
 public:
  Restricted(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual)
      : both_(jacobian.rows(), jacobian.cols() + 1) {
    const Eigen::VectorXd scale =
        jacobian.colwise().norm().cwiseMax(std::numeric_limits<double>::min());
    both_ << jacobian * scale.cwiseInverse().asDiagonal(), residual;
  }

  [[nodiscard]] Tried at(const CorrelatedNoise& unit) const {
    Eigen::MatrixXd X = both_;
    const double log_det = whiten(unit, X);
    const Eigen::Index p = X.cols() - 1;
    const auto J = X.leftCols(p);
    const Eigen::LDLT<Eigen::MatrixXd> normal(J.transpose() * J);
    const Eigen::VectorXd target = J.transpose() * X.col(p);
    const auto left = static_cast<double>(X.rows() - p);
    const double least = std::numeric_limits<double>::min();
    const double squares =
        std::max(X.col(p).squaredNorm() - target.dot(normal.solve(target)), least);
    const double sd = std::sqrt(squares / left);
    return {{sd * unit.white, sd * unit.shared, unit.rho},
            left * std::log(squares) + log_det +
                normal.vectorD().array().max(least).log().sum()};
  }

 private:
  Eigen::MatrixXd both_;  // J, r
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
    return noise.weight < kWeightMin * sum;
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
    return unit_noise(squashed(q[0]), std::min(squashed(q[1]), rho_max));
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
  const Eigen::Index of = (rows.rows() + kRowsMax - 1) / kRowsMax;
  if (of <= 1) {
    return rows;
  }
  Eigen::MatrixXd means(rows.rows() / of, rows.cols());
  for (Eigen::Index i = 0; i < means.rows(); ++i) {
    means.row(i) = rows.middleRows(i * of, of).colwise().mean();
  }
  return means;
}

Eigen::MatrixXd not_a_number(Eigen::Index p) {
  return Eigen::MatrixXd::Constant(p, p, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

std::vector<ProbableNoise> noises_of(const Eigen::MatrixXd& jacobian,
                                     const Eigen::VectorXd& residual, double longest) {
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
  Eigen::MatrixXd white = residual;
  (void)whiten(noise, white);
  return white.squaredNorm();
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
                                       Eigen::Index samples) {
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
  for (const auto& [noise, weight] : noises_of(J, averaged(residual.head(samples)))) {
    const double variance = noise.white * noise.white + noise.shared * noise.shared;
    filling += weight * (J.transpose() * times_covariance(noise, J) +
                         variance * expected.transpose() * expected);
  }
  return bread * filling * bread;
}

}  // namespace palpate
