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
// Of noise whose slow part is the larger: that makes the fit's errors, and the
// likelihood of every sample would sacrifice it for the quick one. Means of neighbours
// would hide what differs from sample to sample, and fold a vibration.
constexpr Eigen::Index kCoarseRows = 200;
// Noises that are tried: shares of all that neighbours share, and lengths [samples].
constexpr std::array<double, 6> kShares{0.03, 0.12, 0.3, 0.6, 0.9, 1.0};
constexpr double kShortest = 0.5, kShortestSmooth = 2.0;
constexpr double kLongestPerSample = 0.25;
constexpr int kLengths = 12;
constexpr Eigen::Index kLeftMin = 20;  // fewer tell nothing of what they share
constexpr double kNoiseWeightMin = 1e-3;
constexpr Eigen::Index kOrderMax = 40, kSamplesPerOrder = 10;
constexpr double kSizeMin = 1e-3;  // of residuals near a sample, of that of all
constexpr double kFreedomMin = 3.0;
constexpr double kSure = 0.5;  // the grid is coarser than what samples tell

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
    // -2 ln of the restricted likelihood (Patterson, Thompson 1971), but for constants,
    // at the best scale: (n - p) ln S + ln|V| + ln|J^T V^-1 J|. S is the squares r^T
    // V^-1 r that a shift of the parameters leaves.
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
    CorrelatedNoise noise = unit;
    noise.white *= sd;
    noise.shared *= sd;
    return {std::move(noise), left * std::log(squares) + log_det +
                                  normal.vectorD().array().max(least).log().sum()};
  }

 private:
  Eigen::MatrixXd both_;  // (p + 1 x n) of J, r
};

// White noise, the first, is as probable before as all shared ones together, and so is
// an autoregression.
std::vector<ProbableNoise> weighed(const std::vector<Tried>& tried) {
  // Weight: probability before the data times exp(-cost / 2), from the least cost.
  const auto least =
      std::min_element(tried.begin(), tried.end(), [](const Tried& a, const Tried& b) {
        return a.cost < b.cost;
      })->cost;
  std::vector<ProbableNoise> noises;
  double sum = 0.0;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    const bool alone = i == 0 || tried[i].noise.regression;
    const double before = alone ? static_cast<double>(tried.size() - 1) : 1.0;
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
Eigen::MatrixXd averaged(const Eigen::MatrixXd& rows, Eigen::Index rows_max) {
  const Eigen::Index of = (rows.rows() + rows_max - 1) / rows_max;
  if (of <= 1) {
    return rows;
  }
  Eigen::MatrixXd means(rows.rows() / of, rows.cols());
  for (Eigen::Index i = 0; i < means.rows(); ++i) {
    means.row(i) = rows.middleRows(i * of, of).colwise().mean();
  }
  return means;
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

bool white_among(const std::vector<ProbableNoise>& noises) {
  return std::any_of(noises.begin(), noises.end(), [](const ProbableNoise& noise) {
    return !(noise.noise.shared > 0.0);
  });
}

double variance_of(const std::vector<ProbableNoise>& noises) {
  double mean = 0.0;
  for (const auto& [noise, weight] : noises) {
    mean += weight * noise.variance();
  }
  return mean;
}

// A variance that few independent samples tell makes 95 % intervals Student's: theirs
// over the normal one (Cornish and Fisher). The slow part of an autoregression of order
// p is known as from n / (2 p) of them (Berk 1974). Where white noise is probable too,
// the mean over all noises has that already.
double widened(const std::vector<ProbableNoise>& noises, Eigen::Index n,
               Eigen::Index p) {
  if (white_among(noises)) {
    return 1.0;
  }
  double independent = 0.0;
  for (const auto& [noise, weight] : noises) {
    const double most =
        noise.regression ? 0.5 / static_cast<double>(noise.regression->order()) : 1.0;
    independent +=
        weight * std::min(most, noise.variance() / noise.long_run_variance());
  }
  const double nu = std::max(
      kFreedomMin, independent * static_cast<double>(n) - static_cast<double>(p));
  return 1.0 + 1.21 / nu + 1.44 / (nu * nu);
}

Eigen::MatrixXd not_a_number(Eigen::Index p) {
  return Eigen::MatrixXd::Constant(p, p, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

std::vector<ProbableNoise> noises_of(const Eigen::MatrixXd& jacobian,
                                     const Eigen::VectorXd& residual, SharedNoise kinds,
                                     double longest) {
  // 1. Too few samples: white noise of the residuals' variance.
  const Eigen::Index n = residual.size();
  const Eigen::Index left = n - jacobian.cols();
  if (left < kLeftMin || !(residual.squaredNorm() > 0.0)) {
    const auto degrees = static_cast<double>(std::max<Eigen::Index>(1, left));
    return {{{.white = std::sqrt(residual.squaredNorm() / degrees)}, 1.0}};
  }
  // 2. White noise, and a grid of lengths (equal ratios) by shares, rho = exp(-1 /
  //    length).
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
  // 3. An autoregression, at the price of order ln n in -2 ln likelihood. One of order
  //    1 that is positive is among the grid.
  if (kinds == SharedNoise::kAlsoRegression) {
    const Autoregression seen =
        autoregression_of(residual, std::min(kOrderMax, n / kSamplesPerOrder));
    const auto order = seen.order();
    if (order > 1 || seen.coefficients.back().sum() < 0.0) {
      auto regression =
          std::make_shared<const Autoregression>(before_fit(seen, jacobian));
      tried.push_back(
          likelihood.at({.shared = 1.0, .regression = std::move(regression)}));
      tried.back().cost +=
          static_cast<double>(order) * std::log(static_cast<double>(n));
    }
  }
  // 4. The weights; one noise that is surely the most probable is refined off the grid.
  std::vector<ProbableNoise> noises = weighed(tried);
  const auto best = std::max_element(
      noises.begin(), noises.end(), [](const ProbableNoise& a, const ProbableNoise& b) {
        return a.weight < b.weight;
      });
  if (best->weight > kSure && best->noise.shared > 0.0 && !best->noise.regression) {
    return {{refined(likelihood, best->noise, longest), 1.0}};
  }
  return noises;
}

double effective_samples(std::span<const double> residuals) {
  const std::size_t n = residuals.size();
  // n (1 - rho) / (1 + rho), rho the correlation of neighbours; n where rho is not
  // beyond two standard errors.
  double squares = 0.0, products = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    squares += residuals[i] * residuals[i];
    products += i + 1 < n ? residuals[i] * residuals[i + 1] : 0.0;
  }
  const double rho = squares > 0.0 ? products / squares : 0.0;
  const auto count = static_cast<double>(n);
  return rho > 2.0 / std::sqrt(count) ? count * (1.0 - rho) / (1.0 + rho) : count;
}

double long_run_variance(const std::vector<ProbableNoise>& noises) {
  double mean = 0.0;
  for (const auto& [noise, weight] : noises) {
    mean += weight * noise.long_run_variance();
  }
  return mean;
}

namespace {

// Covariance under the noise of means of neighbours, and whether that is surely not
// white and its slow part the larger.
struct UnderNoise {
  Eigen::MatrixXd covariance;
  bool slow = false;

  UnderNoise(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
             Eigen::Index samples, SharedNoise kinds, Eigen::Index rows_max) {
    const Eigen::Index p = jacobian.cols();
    // Covariance B M B of a fit whose residuals are correlated: B = (J^T J)^-1, M = J^T
    // V J = `filling`. Rows past `samples` are expectations, independent of the rest.
    const Eigen::MatrixXd J = averaged(jacobian.topRows(samples), rows_max);
    const double times = static_cast<double>(samples) / static_cast<double>(J.rows());
    const Eigen::MatrixXd expected =
        jacobian.bottomRows(jacobian.rows() - samples) / std::sqrt(times);
    Eigen::MatrixXd all(J.rows() + expected.rows(), p);
    all << J, expected;
    const Eigen::MatrixXd bread =  // (J^T J)^-1
        covariance_of(all, static_cast<double>(all.rows() - p));
    if (p == 0 || !bread.allFinite()) {
      covariance = not_a_number(p);
      return;
    }
    Eigen::MatrixXd filling = Eigen::MatrixXd::Zero(p, p);
    const Eigen::VectorXd r = averaged(residual.head(samples), rows_max);
    const Eigen::VectorXd size = kinds == SharedNoise::kAlsoSmooth
                                     ? local_size(r)
                                     : Eigen::VectorXd::Ones(r.size());
    const Eigen::MatrixXd sized = size.asDiagonal() * J;
    const auto noises =
        noises_of(size.cwiseInverse().asDiagonal() * J, r.cwiseQuotient(size), kinds);
    for (const auto& [noise, weight] : noises) {
      filling += weight * (sized.transpose() * times_covariance(noise, sized) +
                           noise.variance() * expected.transpose() * expected);
    }
    slow = !white_among(noises) && long_run_variance(noises) > variance_of(noises);
    const double student =
        kinds == SharedNoise::kAlsoRegression ? widened(noises, r.size(), p) : 1.0;
    covariance = student * student * bread * filling * bread;
  }
};

}  // namespace

Eigen::MatrixXd covariance_under_noise(const Eigen::MatrixXd& jacobian,
                                       const Eigen::VectorXd& residual,
                                       Eigen::Index samples, SharedNoise kinds) {
  const UnderNoise fine{jacobian, residual, samples, kinds, kNoiseRowsMax};
  if (!fine.slow || kinds != SharedNoise::kAlsoRegression || samples <= kCoarseRows) {
    return fine.covariance;
  }
  return UnderNoise{jacobian, residual, samples, kinds, kCoarseRows}.covariance;
}

}  // namespace palpate
