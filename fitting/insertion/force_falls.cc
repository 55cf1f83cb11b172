#include "fitting/insertion/force_falls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "fitting/numerics/robust_statistics.h"

namespace palpate {
namespace {

constexpr std::array<std::size_t, 4> kWindows{1, 2, 4, kFallReach};
constexpr std::size_t kFewest = 40;      // samples
constexpr double kMadEfficiency = 0.37;  // of the median absolute deviation, normal
constexpr double kStillFalling = 5.0;    // deviations of one difference
constexpr double kLeastNoise = 1e-12;    // [-] of the largest force

// Quantile of Student's t from the normal one (Cornish and Fisher).
double student(double z, double freedom) {
  const double z3 = z * z * z, z5 = z3 * z * z;
  return z + (z3 + z) / (4.0 * freedom) +
         (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * freedom * freedom);
}

// Falls of the mean at each place, [N]; place i lies after sample i + m - 1.
std::vector<double> falls_of_means(std::span<const double> f, std::size_t m) {
  std::vector<double> falls;
  double before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < m; ++i) {
    before += f[i];
    after += f[i + m];
  }
  const auto of = static_cast<double>(m);
  for (std::size_t i = 0;; ++i) {
    falls.push_back((before - after) / of);
    if (i + 2 * m >= f.size()) {
      return falls;
    }
    before += f[i + m] - f[i];
    after += f[i + 2 * m] - f[i + m];
  }
}

// Standard deviation of such falls: windows 2 m samples apart share no sample.
double noise_of_falls(const std::vector<double>& falls, std::size_t m) {
  std::vector<double> differences;
  for (std::size_t i = 0; i + 2 * m < falls.size(); ++i) {
    differences.push_back(falls[i + 2 * m] - falls[i]);
  }
  return robust_standard_deviation(differences) / std::numbers::sqrt2;
}

struct FallPlace {
  std::size_t before = 0;
  double deviations = 0.0;  // T_m
  double excess = 0.0;      // [-] over its limit
};

std::vector<FallPlace> places_beyond(std::span<const double> f, double false_rate,
                                     double least_n) {
  std::vector<FallPlace> places;
  const auto all = static_cast<double>(f.size() * kWindows.size());
  const double z = normal_quantile_above(false_rate / all);
  for (const std::size_t m : kWindows) {
    const std::vector<double> falls = falls_of_means(f, m);
    const double noise = std::max(noise_of_falls(falls, m), least_n);
    const double freedom =
        kMadEfficiency * static_cast<double>(f.size()) / (2.0 * static_cast<double>(m));
    const double limit = student(z, std::max(freedom, 4.0));
    for (std::size_t i = 0; i < falls.size(); ++i) {
      if (falls[i] > limit * noise) {
        places.push_back({i + m - 1, falls[i] / noise, falls[i] / (limit * noise)});
      }
    }
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const FallPlace& a, const FallPlace& b) {
                     return a.excess > b.excess;
                   });
  return places;
}

// The steepest step near a place, and how far the force goes on falling.
ForceFall refined_fall(std::span<const double> f, const FallPlace& place,
                       double noise_n) {
  const std::size_t begin = place.before > 1 ? place.before - 2 : 0;
  const std::size_t end = std::min(place.before + 3, f.size() - 1);
  std::size_t steepest = place.before;
  for (std::size_t i = begin; i < end; ++i) {
    steepest = f[i] - f[i + 1] > f[steepest] - f[steepest + 1] ? i : steepest;
  }
  ForceFall fall{steepest, steepest + 1, place.deviations};
  const auto falls_at = [&](std::size_t i) {
    return f[i] - f[i + 1] > kStillFalling * noise_n;
  };
  while (fall.after + 1 < f.size() && falls_at(fall.after)) {
    ++fall.after;
  }
  while (fall.before > 0 && falls_at(fall.before - 1)) {
    --fall.before;
  }
  return fall;
}

}  // namespace

double normal_quantile_above(double probability) {
  double low = 0.0, high = 40.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    const bool above = 0.5 * std::erfc(middle / std::numbers::sqrt2) > probability;
    (above ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

std::vector<ForceFall> find_force_falls(std::span<const double> force_n,
                                        double false_rate) {
  std::vector<ForceFall> falls;
  if (force_n.size() < kFewest) {
    return falls;
  }
  double largest = 0.0;
  for (const double f : force_n) {
    largest = std::max(largest, std::abs(f));
  }
  const double least_n = kLeastNoise * largest;
  const double step_noise =
      std::max(noise_of_falls(falls_of_means(force_n, 1), 1), least_n);
  for (const FallPlace& place : places_beyond(force_n, false_rate, least_n)) {
    const bool near = std::any_of(falls.begin(), falls.end(), [&](const ForceFall& f) {
      return place.before + kFallReach >= f.before &&
             place.before <= f.after + kFallReach;
    });
    if (!near) {
      falls.push_back(refined_fall(force_n, place, step_noise));
    }
  }
  std::sort(falls.begin(), falls.end(), [](const ForceFall& a, const ForceFall& b) {
    return a.before < b.before;
  });
  return falls;
}

}  // namespace palpate
