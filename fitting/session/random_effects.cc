#include "fitting/session/random_effects.h"

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/students_t.hpp>

namespace palpate {
namespace {

using Values = std::vector<double>;

double mean_of(const Values& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

double squares_about(const Values& values, double centre) {
  double squares = 0.0;
  for (const double value : values) {
    squares += (value - centre) * (value - centre);
  }
  return squares;
}

// Of one specimen: means of its points, and 1 / number of repeats of each.
struct Specimen {
  Values point_mean, per_repeats;
  double mean = 0.0;

  [[nodiscard]] double points() const { return static_cast<double>(point_mean.size()); }
};

// Sums of squares with their degrees of freedom; NaN without any.
struct Squares {
  double sum = 0.0, freedom = 0.0;

  [[nodiscard]] double variance() const {
    return freedom > 0.0 ? sum / freedom : RandomEffects::kUnknown;
  }
};

double or_zero(double variance) {
  return std::isnan(variance) ? 0.0 : variance;
}

// E[sum_j (m_ij - m_i)^2] = (1 - 1/p_i) sum_j (point^2 + repeat^2 / n_ij).
double point_variance(const std::vector<Specimen>& specimens, double repeat_variance) {
  Squares between;
  double repeats = 0.0;
  for (const Specimen& s : specimens) {
    between.sum += squares_about(s.point_mean, s.mean);
    between.freedom += s.points() - 1.0;
    repeats += (1.0 - 1.0 / s.points()) * s.points() * mean_of(s.per_repeats);
  }
  return between.freedom > 0.0
             ? std::max(0.0, (between.sum - or_zero(repeat_variance) * repeats) /
                                 between.freedom)
             : RandomEffects::kUnknown;
}

// Variance of a specimen's mean about the specimen: (1/p^2) sum_j (point^2 + repeat^2 /
// n_j).
double inside(const Specimen& s, double point, double repeat) {
  return (or_zero(point) + or_zero(repeat) * mean_of(s.per_repeats)) / s.points();
}

}  // namespace

RandomEffects random_effects(const std::vector<std::vector<Values>>& y) {
  RandomEffects result;
  // 1. Repeats about their point's mean: the repeat's variance.
  std::vector<Specimen> specimens;
  Squares repeats;
  Values means;
  for (const auto& points : y) {
    Specimen& s = specimens.emplace_back();
    for (const Values& values : points) {
      s.point_mean.push_back(mean_of(values));
      s.per_repeats.push_back(1.0 / static_cast<double>(values.size()));
      repeats.sum += squares_about(values, s.point_mean.back());
      repeats.freedom += static_cast<double>(values.size()) - 1.0;
      result.values += values.size();
    }
    s.mean = mean_of(s.point_mean);
    means.push_back(s.mean);
    result.points += points.size();
  }
  result.specimens = y.size();
  result.mean = mean_of(means);
  const double repeat = repeats.variance();
  // 2. Point means about their specimen's mean, less the repeats' part.
  const double point = point_variance(specimens, repeat);
  result.repeat_sd = std::sqrt(repeat);
  result.point_sd = std::sqrt(point);
  if (specimens.size() < 2) {
    return result;
  }
  const auto n = static_cast<double>(specimens.size());
  // 3. Specimen means about their mean, less what points and repeats make of each.
  const double observed = squares_about(means, result.mean) / (n - 1.0);
  double own = 0.0;
  for (const Specimen& s : specimens) {
    own += inside(s, point, repeat) / n;
  }
  result.specimen_sd = std::sqrt(std::max(0.0, observed - own));
  // The means of specimens are independent: their own scatter gives the error of the
  // mean.
  result.mean_sd = std::sqrt(observed / n);
  result.degrees_of_freedom = n - 1.0;
  const double t =
      boost::math::quantile(boost::math::students_t(result.degrees_of_freedom), 0.975);
  result.lower = result.mean - t * result.mean_sd;
  result.upper = result.mean + t * result.mean_sd;
  return result;
}

}  // namespace palpate
