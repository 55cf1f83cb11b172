#include "fitting/curve/adhesion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fitting/numerics/correlated_noise.h"
#include "fitting/numerics/robust_statistics.h"

namespace palpate {
namespace {

constexpr std::size_t kFreeAfterMin = 5;

constexpr double kSlopeDeviations = 4.0;

// Of the free samples before contact only the first two thirds are surely free: a law
// that only pushes finds the contact point after the jump into contact.
std::vector<std::size_t> surely_free(const FreeSamples& free) {
  std::vector<std::size_t> first = free.before;
  first.resize(std::max(kFreeMin, 2 * first.size() / 3));
  return first;
}

// The baseline's slope [N/m]; 0 where it is not beyond kSlopeDeviations of its noise.
double slope_n_per_m(const Measurement& m, const std::vector<std::size_t>& free) {
  const auto n = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd J = Eigen::MatrixXd::Ones(n, 2);
  Eigen::VectorXd f(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::size_t i = free[static_cast<std::size_t>(k)];
    J(k, 1) = m.depth_m[i];
    f[k] = m.force_n[i];
  }
  J.col(1).array() -= J.col(1).mean();
  const double size = J.col(1).norm();
  if (!(size > 0.0)) {
    return 0.0;
  }
  J.col(1) *= std::sqrt(static_cast<double>(n)) / size;
  const Eigen::Vector2d q = J.colPivHouseholderQr().solve(f);
  const double sd = std::sqrt(covariance_under_noise(J, f - J * q, n)(1, 1));
  return std::abs(q[1]) > kSlopeDeviations * sd
             ? q[1] * std::sqrt(static_cast<double>(n)) / size
             : 0.0;
}

std::vector<double> of(const std::vector<double>& f,
                       const std::vector<std::size_t>& samples) {
  std::vector<double> values;
  for (const std::size_t i : samples) {
    values.push_back(f[i]);
  }
  return values;
}

}  // namespace

Adhesion find_adhesion(const Measurement& samples, const Approach& approach,
                       const ContactFit& fit) {
  Adhesion adhesion;
  const Measurement m = turned(samples, approach);
  const FreeSamples free = free_samples(m, approach, fit);
  if (free.before.size() < kFreeMin) {
    return adhesion;
  }
  const std::vector<std::size_t> before = surely_free(free);
  // The baseline's slope, known from free samples, is taken off the whole curve.
  const double slope = slope_n_per_m(m, before);
  std::vector<double> f = m.force_n;
  for (std::size_t i = 0; i < f.size(); ++i) {
    f[i] -= slope * m.depth_m[i];
  }
  const double zero = median(of(f, before));
  adhesion.noise_n =
      std::max(robust_standard_deviation(of(f, before)), approach.noise_sd_n);
  adhesion.zero_n = zero;
  adhesion.slope_n_per_m = slope;
  double zero_after = zero;
  if (free.after.size() >= kFreeAfterMin) {
    zero_after = std::min(zero, median(of(f, free.after)));
  }
  // Depth of the force below the baseline: on the approach (snap-in), and from its end
  // on (pull-off). A median of three keeps single samples out.
  const std::vector<double> smooth = running_median(f, 1);
  for (std::size_t i = before.front(); i < smooth.size(); ++i) {
    double& deepest = i < approach.samples ? adhesion.snap_in_n : adhesion.pull_off_n;
    deepest = std::max(deepest, (i < approach.samples ? zero : zero_after) - smooth[i]);
  }
  const double limit = kAdhesionDeviations * adhesion.noise_n;
  adhesion.pulls_off = adhesion.pull_off_n > limit;
  adhesion.snaps_in = adhesion.snap_in_n > limit;
  return adhesion;
}

double jkr_work_of_adhesion(double pull_off_n, double radius_m) {
  return pull_off_n / (1.5 * std::numbers::pi * radius_m);
}

double dmt_work_of_adhesion(double pull_off_n, double radius_m) {
  return pull_off_n / (2.0 * std::numbers::pi * radius_m);
}

}  // namespace palpate
