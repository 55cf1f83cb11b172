#include "fitting/surface/held_shares.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include <Eigen/LU>

#include "fitting/numerics/nelder_mead.h"
#include "fitting/numerics/robust_statistics.h"

namespace palpate {
namespace {

constexpr double kShareErrorMin = 1e-3;  // [-] no share is known better
constexpr double kShareErrorMax = 0.5;   // a worse one says nothing
constexpr int kTimes = 32;               // from a thousandth of the holds
constexpr double kFarthest = 1.1;        // a factor of 3 between times, as logarithm

RelaxedShare share_of(const SurfaceProbe& probe, double time_s) {
  return relaxed_within(probe.relaxation->joint, time_s);
}

// The nearest on the line from a to b.
Eigen::VectorXd nearest_between(const Eigen::MatrixXd& of_terms,
                                const Eigen::VectorXd& shares, const Eigen::VectorXd& a,
                                const Eigen::VectorXd& b) {
  const Eigen::VectorXd along = of_terms * (b - a);
  const double t = along.dot(shares - of_terms * a) / along.squaredNorm();
  return a + std::clamp(t, 0.0, 1.0) * (b - a);
}

// Mean square over the times, by probe.
std::vector<double> squares_missed(const std::vector<const SurfaceProbe*>& held,
                                   std::span<const double> tau_s, double seconds) {
  const std::vector<double> time_s = share_times_s(tau_s, seconds);
  const Eigen::MatrixXd of_terms = shares_of_terms(time_s, tau_s);
  std::vector<double> squares;
  for (const SurfaceProbe* probe : held) {
    Eigen::VectorXd shares(std::ssize(time_s));
    for (std::size_t m = 0; m < time_s.size(); ++m) {
      shares[static_cast<Eigen::Index>(m)] = share_of(*probe, time_s[m]).value;
    }
    const Eigen::VectorXd g = nearest_terms(of_terms, shares);
    double sum = 0.0;
    for (int k = 0; k < kTimes; ++k) {
      // Times of equal ratios, from the end of the hold to a thousandth of it.
      const double at_s =
          seconds * std::pow(1e-3, static_cast<double>(k) / (kTimes - 1));
      const double common = (shares_of_terms({&at_s, 1}, tau_s) * g).value();
      sum += std::pow(share_of(*probe, at_s).value - common, 2);
    }
    squares.push_back(sum / kTimes);
  }
  return squares;
}

}  // namespace

std::vector<double> share_times_s(std::span<const double> tau_s, double seconds) {
  if (tau_s.size() == 1) {
    return {seconds};
  }
  return {std::min(std::sqrt(tau_s[0] * tau_s[1]), 0.5 * seconds), seconds};
}

Eigen::MatrixXd shares_of_terms(std::span<const double> time_s,
                                std::span<const double> tau_s) {
  Eigen::MatrixXd shares(std::ssize(time_s), std::ssize(tau_s));
  for (Eigen::Index m = 0; m < shares.rows(); ++m) {
    for (Eigen::Index k = 0; k < shares.cols(); ++k) {
      shares(m, k) = -std::expm1(-time_s[static_cast<std::size_t>(m)] /
                                 tau_s[static_cast<std::size_t>(k)]);
    }
  }
  return shares;
}

// Where the g that agree lie outside the simplex, the nearest lie on one of its edges.
Eigen::VectorXd nearest_terms(const Eigen::MatrixXd& of_terms,
                              const Eigen::VectorXd& shares) {
  const Eigen::Index K = of_terms.cols();
  const Eigen::VectorXd free = of_terms.partialPivLu().solve(shares);
  if (free.minCoeff() >= 0.0 && free.sum() <= 1.0) {
    return free;
  }
  Eigen::MatrixXd corner = Eigen::MatrixXd::Zero(K, K + 1);
  corner.rightCols(K).setIdentity();
  Eigen::VectorXd best;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index a = 0; a <= K; ++a) {
    for (Eigen::Index b = a + 1; b <= K; ++b) {
      const Eigen::VectorXd g =
          nearest_between(of_terms, shares, corner.col(a), corner.col(b));
      const double off = (of_terms * g - shares).squaredNorm();
      if (off < least) {
        least = off;
        best = g;
      }
    }
  }
  return best;
}

std::vector<FieldData> held_shares(const std::vector<const SurfaceProbe*>& held,
                                   std::span<const double> time_s) {
  const auto m = std::ssize(held);
  std::vector<FieldData> data(time_s.size(), {Eigen::VectorXd(m), Eigen::VectorXd(m),
                                              std::vector<char>(held.size(), 1)});
  for (std::size_t s = 0; s < time_s.size(); ++s) {
    for (std::size_t i = 0; i < held.size(); ++i) {
      const RelaxedShare share = share_of(*held[i], time_s[s]);
      const auto row = static_cast<Eigen::Index>(i);
      data[s].value[row] = share.value;
      data[s].sd[row] =
          std::isnan(share.sd) ? kShareErrorMin : std::max(share.sd, kShareErrorMin);
      data[s].used[i] = data[s].sd[row] < kShareErrorMax ? 1 : 0;
    }
  }
  for (FieldData& set : data) {  // screening uses all that is finite
    for (std::size_t i = 0; i < held.size(); ++i) {
      if (set.used[i] == 0) {
        set.value[static_cast<Eigen::Index>(i)] =
            std::numeric_limits<double>::quiet_NaN();
      }
    }
  }
  return data;
}

double common_times_error(const std::vector<const SurfaceProbe*>& held,
                          std::span<const double> tau_s, double seconds) {
  const std::vector<double> squares = squares_missed(held, tau_s, seconds);
  return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) /
                   static_cast<double>(squares.size()));
}

std::vector<double> times_that_miss_least_s(
    const std::vector<const SurfaceProbe*>& held, std::span<const double> tau_s,
    double seconds) {
  const auto times_of = [](const Eigen::VectorXd& x) {
    const Eigen::VectorXd tau = x.array().exp();
    return std::vector<double>(tau.begin(), tau.end());
  };
  const Eigen::VectorXd start =
      Eigen::Map<const Eigen::VectorXd>(tau_s.data(), std::ssize(tau_s)).array().log();
  const SimplexReport found = minimise_simplex(
      [&](const Eigen::VectorXd& x) {
        const bool rising =
            std::adjacent_find(x.begin(), x.end(), std::greater_equal<>()) == x.end();
        return rising && (x - start).cwiseAbs().maxCoeff() < kFarthest
                   ? std::sqrt(median(squares_missed(held, times_of(x), seconds)))
                   : std::numeric_limits<double>::infinity();
      },
      start, {.step = 0.1, .tolerance_x = 1e-3, .tolerance_f = 1e-6});
  return times_of(found.x);
}

}  // namespace palpate
