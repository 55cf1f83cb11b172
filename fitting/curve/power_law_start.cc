#include "fitting/curve/power_law_start.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace palpate {
namespace {

constexpr int kGrid = 32;              // contact points
constexpr double kStartsApart = 0.05;  // [-] of the travel
constexpr double kExponents[] = {1.0, 1.5, 2.0, 3.0};

struct RankedModel {
  double cost;
  ContactModel model;
};

struct Line {
  double offset, slope, sd;
};

Line line_through(std::span<const double> x, std::span<const double> f) {
  const auto n = static_cast<Eigen::Index>(x.size());
  const Eigen::Map<const Eigen::ArrayXd> xs(x.data(), n), fs(f.data(), n);
  const Eigen::ArrayXd dx = xs - xs.mean();
  const double spread = dx.square().sum();
  const double slope = spread > 0.0 ? (dx * fs).sum() / spread : 0.0;
  const double offset = fs.mean() - slope * xs.mean();
  return {offset, slope, std::sqrt((fs - offset - slope * xs).square().mean())};
}

double variance(std::span<const double> values) {
  const Eigen::Map<const Eigen::ArrayXd> v(values.data(),
                                           static_cast<Eigen::Index>(values.size()));
  return (v - v.mean()).square().mean();
}

// d^p without std::pow for the exponents that are tried most.
double power(double d, double p) {
  return p == 1.0   ? d
         : p == 1.5 ? d * std::sqrt(d)
         : p == 2.0 ? d * d
         : p == 3.0 ? d * d * d
                    : std::pow(d, p);
}

// Linear least squares for the three linear parameters at a given contact and exponent.
RankedModel linear_fit(const ScaledCurve& curve, double contact, double exponent) {
  // Normal equations of b0 + b1 x + K <x - contact>^exponent; cost f^T f - q^T A^T f.
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double squares = 0.0;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const double d = curve.x[i] - contact;
    const Eigen::Vector3d basis(1.0, curve.x[i], d > 0.0 ? power(d, exponent) : 0.0);
    normal.noalias() += basis * basis.transpose();
    right += curve.f[i] * basis;
    squares += curve.f[i] * curve.f[i];
  }
  // A touch of ridge on the drift decides where line and contact are the same thing.
  normal(1, 1) += 1e-6 * static_cast<double>(curve.x.size());
  const Eigen::Vector3d solution = normal.ldlt().solve(right);
  return {squares - solution.dot(right),
          {solution[0], solution[1], contact, exponent, solution[2]}};
}

}  // namespace

ScaledCurve samples_of(const ScaledCurve& curve,
                       const std::vector<std::size_t>& which) {
  ScaledCurve some;
  some.contact_min = curve.contact_min;
  some.drift_weight = curve.drift_weight;
  for (const std::size_t i : which) {
    some.x.push_back(curve.x[i]);
    some.f.push_back(curve.f[i]);
    if (!curve.weight.empty()) {
      some.weight.push_back(curve.weight[i]);
    }
  }
  return some;
}

ScaledCurve thinned(const ScaledCurve& curve) {
  const std::size_t step = std::max<std::size_t>(1, curve.x.size() / kThinnedSamples);
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < curve.x.size(); i += step) {
    which.push_back(i);
  }
  return samples_of(curve, which);
}

std::optional<double> deviation_from_baseline(const ScaledCurve& curve) {
  const std::size_t n = curve.x.size();
  const std::size_t first = std::max<std::size_t>(3, n / 5);
  const Line line =
      line_through(std::span(curve.x).first(first), std::span(curve.f).first(first));
  int beyond = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double excess = curve.f[i] - line.offset - line.slope * curve.x[i];
    beyond = excess > 5.0 * line.sd ? beyond + 1 : 0;
    if (beyond == 3) {
      return curve.x[i - 2];
    }
  }
  return std::nullopt;
}

double ratio_of_variances(const ScaledCurve& curve) {
  const std::size_t n = curve.x.size();
  const std::size_t window = std::max<std::size_t>(3, n / 20);
  double largest = -1.0;
  double where = curve.x.front();
  for (std::size_t i = window; i + window < n; ++i) {
    const std::span f(curve.f);
    const double ratio = variance(f.subspan(i, window)) /
                         (variance(f.subspan(i - window, window)) + 1e-12);
    if (ratio > largest) {
      largest = ratio;
      where = curve.x[i];
    }
  }
  return where;
}

std::vector<ContactModel> contact_starts(const ScaledCurve& curve,
                                         std::optional<double> exponent,
                                         std::size_t count) {
  // 1. Contact points: by the ratio of variances, by the departure from the baseline,
  //    and on a grid over the travel.
  const ScaledCurve thin = thinned(curve);
  std::vector<double> contacts = {ratio_of_variances(thin)};
  if (const auto late = deviation_from_baseline(thin)) {
    contacts.push_back(*late);
  }
  for (int i = 0; i < kGrid; ++i) {
    contacts.push_back(static_cast<double>(i) / kGrid);
  }
  for (double& contact : contacts) {
    contact = std::max(contact, curve.contact_min);
  }
  // 2. The linear parameters at each contact point and exponent; only rising laws
  //    count.
  std::vector<RankedModel> ranked;
  for (const double contact : contacts) {
    for (const double candidate : kExponents) {
      const RankedModel fit = linear_fit(thin, contact, exponent.value_or(candidate));
      if (fit.model.coefficient > 0.0 && std::isfinite(fit.cost)) {
        ranked.push_back(fit);
      }
      if (exponent) {
        break;
      }
    }
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) {
    return a.cost < b.cost;
  });
  // 3. The best whose contact points are apart.
  std::vector<ContactModel> starts;
  for (const RankedModel& next : ranked) {
    const bool apart =
        std::all_of(starts.begin(), starts.end(), [&](const ContactModel& start) {
          return std::abs(start.contact - next.model.contact) >= kStartsApart;
        });
    if (apart && starts.size() < count) {
      starts.push_back(next.model);
    }
  }
  return starts;
}

}  // namespace palpate
