#include "fitting/curve/misfit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/QR>

#include "fitting/numerics/robust_statistics.h"

namespace palpate {
namespace {

constexpr double kSureMisfitDeviations = 5.0, kDoubtDeviations = 3.0;
constexpr double kSureShareMin = 1e-4, kShareMin = 1e-3;  // [-] of the forces' range
constexpr double kClip = 5.0;                             // robust standard deviations
constexpr Eigen::Index kIntervals = 24;
constexpr Eigen::Index kMisfitRowsMax = 400;
constexpr Eigen::Index kRowsPerInterval = 14;

// Displacements at even shares of the samples, equal ones once.
std::vector<double> knots_of(std::vector<double> x, Eigen::Index intervals) {
  std::sort(x.begin(), x.end());
  std::vector<double> knots;
  for (Eigen::Index k = 0; k <= intervals; ++k) {
    knots.push_back(x[static_cast<std::size_t>(k * (std::ssize(x) - 1) / intervals)]);
  }
  knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
  return knots;
}

// The four cubic B-splines that are not zero between knots j and j + 1 (Cox, de Boor).
std::array<double, 4> cubic_splines(const std::vector<double>& knots, std::ptrdiff_t j,
                                    double x) {
  const auto at = [&](std::ptrdiff_t k) {
    return knots[static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(k, 0, std::ssize(knots) - 1))];
  };
  std::array<double, 4> N{1.0, 0.0, 0.0, 0.0};
  for (std::ptrdiff_t degree = 1; degree <= 3; ++degree) {
    double carried = 0.0;
    for (std::ptrdiff_t r = 0; r < degree; ++r) {
      const double right = at(j + r + 1) - x, left = x - at(j + 1 - degree + r);
      const auto k = static_cast<std::size_t>(r);
      const double share = N[k] / (right + left);
      N[k] = carried + right * share;
      carried = left * share;
    }
    N[static_cast<std::size_t>(degree)] = carried;
  }
  return N;
}

// (n x intervals + 3)
Eigen::MatrixXd spline_basis(const Eigen::VectorXd& x, Eigen::Index intervals) {
  const std::vector<double> knots = knots_of({x.begin(), x.end()}, intervals);
  if (knots.size() < 2) {
    return Eigen::MatrixXd::Ones(x.size(), 1);
  }
  const auto last = std::ssize(knots) - 2;
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(x.size(), last + 4);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const auto above = std::upper_bound(knots.begin(), knots.end(), x[i]);
    const auto j = std::clamp<std::ptrdiff_t>(above - knots.begin() - 1, 0, last);
    const auto N = cubic_splines(knots, j, x[i]);
    for (Eigen::Index k = 0; k < 4; ++k) {
      S(i, j + k) = N[static_cast<std::size_t>(k)];
    }
  }
  return S;
}

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& S) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(S);
  return qr.householderQ() * Eigen::MatrixXd::Identity(S.rows(), qr.rank());
}

// Few samples that stand out are no noise: a step that no curve follows.
std::vector<double> clipped(std::span<const double> residual) {
  std::vector<double> values(residual.begin(), residual.end());
  const double limit = kClip * robust_standard_deviation(values);
  for (double& value : values) {
    value = limit > 0.0 ? std::clamp(value, -limit, limit) : value;
  }
  return values;
}

// What samples that touch nothing are beside a straight line is their noise.
std::vector<ProbableNoise> noises_beside_line(const Eigen::VectorXd& x,
                                              const Eigen::VectorXd& r) {
  Eigen::MatrixXd line(r.size(), 2);
  line << Eigen::VectorXd::Ones(r.size()), x;
  line.col(1).array() -= x.mean();
  const Eigen::VectorXd left = r - line * line.colPivHouseholderQr().solve(r);
  return noises_of(line, left, SharedNoise::kAlsoRegression);
}

}  // namespace

bool may_miss(const Misfit& misfit, double force_range) {
  return misfit.deviations > kDoubtDeviations &&
         misfit.missed_rms > kSureShareMin * force_range;
}

bool is_sure(const Misfit& misfit, double force_range) {
  return misfit.deviations > kSureMisfitDeviations && may_miss(misfit, force_range);
}

bool matters(const Misfit& misfit, double force_range) {
  return is_sure(misfit, force_range) && misfit.missed_rms > misfit.noise_sd &&
         misfit.missed_rms > kShareMin * force_range;
}

Eigen::VectorXd ResidualNoise::averaged(std::span<const double> values) const {
  const Eigen::Map<const Eigen::VectorXd> all(values.data(), std::ssize(values));
  Eigen::VectorXd means(samples_ / together_);
  for (Eigen::Index i = 0; i < means.size(); ++i) {
    means[i] = all.segment(i * together_, together_).mean();
  }
  return means;
}

ResidualNoise::ResidualNoise(std::span<const double> x, std::span<const double> all,
                             std::size_t free)
    : samples_(std::ssize(all)),
      together_(
          std::max<Eigen::Index>(1, (samples_ + kMisfitRowsMax - 1) / kMisfitRowsMax)) {
  const std::vector<double> residual = clipped(all);
  const Eigen::VectorXd r = averaged(residual);
  const Eigen::VectorXd at = averaged(x);
  Q_ = orthonormal(spline_basis(
      at, std::clamp<Eigen::Index>(r.size() / kRowsPerInterval, 1, kIntervals)));
  double variance = 0.0;  // of a row
  const double interval =
      static_cast<double>(r.size()) / static_cast<double>(Q_.cols());
  const auto first = static_cast<Eigen::Index>(free) / together_;
  noises_ = first > 0 ? noises_beside_line(at.head(first), r.head(first))
                      : noises_of(Q_, r - Q_ * (Q_.transpose() * r),
                                  SharedNoise::kRough, std::max(1.0, interval));
  double squares = 0.0;  // of what the spline is expected to take
  for (auto& [noise, weight] : noises_) {
    noise.white = std::max(noise.white, std::numeric_limits<double>::min());
    // Noise of covariance V in the k columns of Q: expected squares tr M, M = Q^T V Q,
    // of variance 2 |M|^2.
    squares_.push_back(weighed_squares(noise, r));
    const Eigen::MatrixXd M = Q_.transpose() * times_covariance(noise, Q_);
    expected_ += weight * M.trace();
    squares += weight * std::pow(M.trace(), 2);
    expected_sd_ += weight * std::sqrt(2.0 * M.squaredNorm());
    const double all_of_it = noise.variance();
    long_run_variance_ += weight * noise.long_run_variance();
    variance += weight * all_of_it;
    independent_ +=
        weight * (all_of_it > 0.0 ? all_of_it / noise.long_run_variance() : 1.0);
  }
  if (first > 0) {
    // Few free samples leave open how much noise there is: their residuals say it as
    // the spline's share of all does.
    const double open = std::max(0.0, squares - expected_ * expected_) +
                        std::pow(expected_sd_, 2) * static_cast<double>(r.size()) /
                            static_cast<double>(first);
    expected_sd_ = std::sqrt(std::pow(expected_sd_, 2) + open);
  }
  // Rows are means: within them the samples differ by what the means do not have.
  double within = 0.0;
  for (Eigen::Index i = 0; i < r.size() * together_; ++i) {
    const double apart = residual[static_cast<std::size_t>(i)] - r[i / together_];
    within += apart * apart;
  }
  noise_sd_ = std::sqrt(variance + within / static_cast<double>(r.size() * together_));
  long_run_variance_ *= static_cast<double>(together_);
  // A row's noise in units of a sample's: what differs within it is independent.
  independent_ *= variance > 0.0 ? noise_sd_ * noise_sd_ / variance : 1.0;
  independent_ = std::min(static_cast<double>(samples_),
                          independent_ * static_cast<double>(r.size()));
}

double ResidualNoise::deviance(std::span<const double> residual) const {
  // -2 ln of sum_i w_i exp(-(S_i - S_i of the noise's own residuals) / 2), S_i = r^T
  // V_i^-1 r.
  const Eigen::VectorXd r = averaged(residual);
  std::vector<double> logs;
  for (std::size_t i = 0; i < noises_.size(); ++i) {
    const auto& [noise, weight] = noises_[i];
    logs.push_back(std::log(weight) - 0.5 * (weighed_squares(noise, r) - squares_[i]));
  }
  const double most = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double value : logs) {
    sum += std::exp(value - most);
  }
  return -2.0 * (most + std::log(sum));
}

Misfit ResidualNoise::misfit(std::span<const double> residual) const {
  const Eigen::VectorXd r = averaged(residual);
  // What the spline takes of the residuals beyond what it takes of noise alone.
  const double more = (Q_.transpose() * r).squaredNorm() - expected_;
  Misfit misfit{.noise_sd = noise_sd_, .long_run_sd = std::sqrt(long_run_variance_)};
  misfit.missed_rms = std::sqrt(std::max(0.0, more) / static_cast<double>(r.size()));
  misfit.deviations = more > 0.0 ? more / std::max(expected_sd_, 1e-300) : 0.0;
  // What is too sharp for the spline shows in the sum of squares.
  const Eigen::Map<const Eigen::VectorXd> all(residual.data(), std::ssize(residual));
  const double noise = noise_sd_ * noise_sd_;
  const double extra = all.squaredNorm() / static_cast<double>(all.size()) - noise;
  if (extra > misfit.missed_rms * misfit.missed_rms) {
    misfit.missed_rms = std::sqrt(extra);
    misfit.deviations = std::max(misfit.deviations, extra / std::max(noise, 1e-300) *
                                                        std::sqrt(independent_ / 2.0));
  }
  return misfit;
}

Misfit find_misfit(std::span<const double> x, std::span<const double> residual) {
  return ResidualNoise(x, residual).misfit(residual);
}

}  // namespace palpate
