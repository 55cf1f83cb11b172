#include "fitting/curve/free_travel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "fitting/curve/power_law_search.h"
#include "fitting/numerics/correlated_noise.h"
#include "fitting/numerics/least_squares.h"
#include "fitting/numerics/robust_statistics.h"

namespace palpate {
namespace {

constexpr std::size_t kFreeToJudge = 5 * kSamplesMin;
constexpr double kWiggleShareMax = 0.02;  // [-] of the forces' range
constexpr double kFlatShares[] = {1.0 / 6, 1.0 / 12, 1.0 / 24,
                                  1.0 / 48};  // of the travel
constexpr double kFlatSlope = 0.05;           // [-] of the force range over the travel
constexpr std::ptrdiff_t kFlatSamplesMin = 8;
constexpr double kFallenNoises = 10.0, kFallOfPeak = 0.1;
constexpr double kSureBend = 4.0;  // standard deviations

// Of the law less the samples, outliers left out, in the samples' order.
struct Residuals {
  std::vector<double> x, r;

  // How many of the first are before a displacement.
  [[nodiscard]] std::size_t until(double x_m) const {
    return static_cast<std::size_t>(std::find_if(x.begin(), x.end(),
                                                 [&](double at) {
                                                   return at >= x_m;
                                                 }) -
                                    x.begin());
  }
};

Residuals residuals_of(const Approach& approach, const ContactFit& fit) {
  std::vector<double> all;
  for (std::size_t i = 0; i < approach.force_n.size(); ++i) {
    const double at = approach.displacement_m[i];
    all.push_back(fit.parameters[0].value + fit.parameters[1].value * at +
                  contact_force_n(fit, at - fit.contact_point_m) - approach.force_n[i]);
  }
  Residuals found;
  const double limit =
      kOutlierDeviations * std::max(fit.rms_n, approach.noise_sd_n) + 1e-15;
  for (const std::size_t i : without_outliers(all, limit)) {
    found.x.push_back(approach.displacement_m[i]);
    found.r.push_back(all[i]);
  }
  return found;
}

// Drift through the samples before contact: in (x - middle) / half.
struct Parabola {
  double middle = 0.0, half = 1.0;
  Eigen::VectorXd q;
  Eigen::MatrixXd J;
};

Parabola parabola_through(const Eigen::Map<const Eigen::VectorXd>& x,
                          const Eigen::Map<const Eigen::VectorXd>& f) {
  Parabola p;
  p.middle = x.mean();
  p.half = 0.5 * (x.maxCoeff() - x.minCoeff());
  p.J.resize(x.size(), 3);
  p.J.col(0).setOnes();
  p.J.col(1) = (x.array() - p.middle) / p.half;
  p.J.col(2) = p.J.col(1).array().square();
  p.q = p.J.colPivHouseholderQr().solve(f);
  return p;
}

}  // namespace

bool is_led_astray(const Approach& approach, const ContactFit& fit) {
  const double range = extent(approach.force_n);
  if (is_sure(fit.misfit, range)) {
    return true;
  }
  std::vector<double> x, residual;
  for (std::size_t i = 0; i < approach.force_n.size(); ++i) {
    const double at = approach.displacement_m[i];
    if (at < fit.contact_point_m) {
      x.push_back(at);
      residual.push_back(fit.parameters[0].value + fit.parameters[1].value * at -
                         approach.force_n[i]);
    }
  }
  return x.size() >= 2 * kSamplesMin && matters(find_misfit(x, residual), range);
}

bool explain_by_free_travel(const Approach& approach, ContactFit& fit) {
  if (fit.noise_relative > 0.0 || fit.has(FitFlag::kAlreadyInContact)) {
    return false;
  }
  const Residuals all = residuals_of(approach, fit);
  const std::size_t free =
      std::max(all.until(approach.contact_from_m), all.until(fit.contact_point_m) / 2);
  if (free < kFreeToJudge || free == all.x.size()) {
    return false;
  }
  const double range = extent(approach.force_n);
  const Misfit misfit = ResidualNoise(all.x, all.r, free).misfit(all.r);
  if (is_sure(misfit, range) || misfit.noise_sd > kWiggleShareMax * range) {
    return false;
  }
  fit.misfit = misfit;
  fit.free_to_m = all.x[free];
  return true;
}

bool DriftBend::is_sure() const {
  return deviations > kSureBend;
}

std::optional<DriftBend> bend_of_drift(const Approach& approach,
                                       const ContactFit& fit) {
  if (fit.has(FitFlag::kAlreadyInContact)) {
    return std::nullopt;
  }
  const Residuals all = residuals_of(approach, fit);
  const std::size_t free = all.until(fit.contact_point_m);
  if (free < kFreeToJudge) {
    return std::nullopt;
  }
  const auto n = static_cast<Eigen::Index>(free);
  const Eigen::Map<const Eigen::VectorXd> x(all.x.data(), n), r(all.r.data(), n);
  if (!(x.maxCoeff() > x.minCoeff())) {
    return std::nullopt;
  }
  // q[2] [N] is how much the law less the samples bends over half of the free travel.
  const Parabola p = parabola_through(x, r);
  const Eigen::VectorXd left = r - p.J * p.q;
  const double range = extent(approach.force_n), size = std::abs(p.q[2]);
  const double white_sd = std::sqrt(covariance_of(p.J, left.squaredNorm())(2, 2));
  if (!(size > white_sd && size <= kWiggleShareMax * range)) {
    return std::nullopt;
  }
  // The bend counts if it exceeds its noise, white and correlated, and leaves no
  // misfit.
  const double sd =
      std::max(white_sd, std::sqrt(covariance_under_noise(
                             p.J, left, n, SharedNoise::kAlsoRegression)(2, 2)));
  if (!(size > sd) ||
      is_sure(find_misfit({all.x.data(), free}, {left.data(), free}), range)) {
    return std::nullopt;
  }
  DriftBend bend{{approach, approach}, size / sd, std::pow(white_sd / sd, 2)};
  for (std::size_t i = 0; i < approach.force_n.size(); ++i) {
    const double at = (approach.displacement_m[i] - p.middle) / p.half;
    // Two ways to go on in contact: the parabola itself, or its tangent from the last
    // free sample on. Added to the force, either takes the bend off.
    bend.straight[0].force_n[i] += p.q[2] * at * at;
    bend.straight[1].force_n[i] += p.q[2] * (at > 1.0 ? 2.0 * at - 1.0 : at * at);
  }
  return bend;
}

double bend_sd(const DriftBend& bend, const ContactFit& fit,
               const std::array<ContactFit, 2>& straight,
               const std::array<double, 2>& moved) {
  const auto rms_n = [](const ContactFit& of) {
    return std::max(of.rms_n, std::numeric_limits<double>::min());
  };
  std::array<double, 2> gain{};  // of the logarithm of the likelihood
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t samples = std::min(fit.samples_used, straight[k].samples_used);
    gain[k] = bend.independent * static_cast<double>(samples) *
              std::log(rms_n(fit) / rms_n(straight[k]));
  }
  // sqrt((1 - 1/deviations^2) sum_k w_k moved_k^2 / sum w), w_k = exp(gain_k) the
  // likelihood of way k over that of no bend.
  const double most = std::max({0.0, gain[0], gain[1]});
  // Of no bend: twice as likely as either way, and one parameter less.
  double weights = 2.0 * std::exp(1.0 - most);
  double squares = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    const double weight = std::exp(gain[k] - most);
    weights += weight;
    squares += weight * moved[k] * moved[k];
  }
  return std::sqrt((1.0 - std::pow(bend.deviations, -2)) * squares / weights);
}

std::optional<double> flat_until_m(const Approach& approach) {
  const ScaledCurve curve = scale_approach(approach, 0.0).curve;
  for (const double share : kFlatShares) {
    const auto first = std::count_if(curve.x.begin(), curve.x.end(), [&](double x) {
      return x < share;
    });
    if (first < kFlatSamplesMin) {
      break;
    }
    const Eigen::Map<const Eigen::ArrayXd> x(curve.x.data(), first),
        f(curve.f.data(), first);
    const Eigen::ArrayXd dx = x - x.mean(), df = f - f.mean();
    const double slope = (dx * df).sum() / dx.square().sum();
    const double sd = std::sqrt((df - slope * dx).square().sum() /
                                static_cast<double>(first - 2) / dx.square().sum());
    if (std::abs(slope) <= kFlatSlope && sd <= kFlatSlope) {
      const auto& all = approach.displacement_m;
      return *std::min_element(all.begin(), all.end()) + share * extent(all);
    }
  }
  return std::nullopt;
}

std::optional<Approach> before_fall(const Approach& approach) {
  const std::vector<double> smooth = running_median(approach.force_n, 2);
  std::size_t peak = 0, i = 0;
  const auto fallen = [&] {
    const double height = smooth[peak] - smooth.front();
    return smooth[peak] - smooth[i] > std::max(kFallenNoises * approach.noise_sd_n,
                                               kFallOfPeak * std::abs(height));
  };
  for (; i < smooth.size() && !fallen(); ++i) {
    peak = smooth[i] > smooth[peak] ? i : peak;
  }
  if (i == smooth.size() || peak < 2 * kSamplesMin) {
    return std::nullopt;
  }
  Approach part = approach;
  part.displacement_m.resize(peak + 1);
  part.force_n.resize(peak + 1);
  if (!(extent(part.displacement_m) > 0.0)) {
    return std::nullopt;
  }
  return part;
}

}  // namespace palpate
