#include "fitting/surface/probe_repeats.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fitting/numerics/robust_statistics.h"

namespace palpate {
namespace {

constexpr double kFarScore = 4.5;

double value_of(const FieldData& set, std::size_t i) {
  return set.value[static_cast<Eigen::Index>(i)];
}
double error_of(const FieldData& set, std::size_t i) {
  return set.sd[static_cast<Eigen::Index>(i)];
}

std::vector<std::size_t> used_of(const FieldData& set,
                                 const std::vector<std::size_t>& place) {
  std::vector<std::size_t> used;
  std::copy_if(place.begin(), place.end(), std::back_inserter(used),
               [&](std::size_t i) {
                 return set.used[i] != 0;
               });
  return used;
}

double median_of(const FieldData& set, const std::vector<std::size_t>& presses) {
  std::vector<double> values;
  for (const std::size_t i : presses) {
    values.push_back(value_of(set, i));
  }
  return median(values);
}

// From differences of pairs at one place: a place's own value is in none of them.
double repeatability_of(const FieldData& set,
                        const std::vector<std::vector<std::size_t>>& places) {
  std::vector<double> off;
  double stated = 0.0;
  std::size_t degrees = 0;
  for (const auto& place : places) {
    const auto used = used_of(set, place);
    degrees += used.empty() ? 0 : used.size() - 1;
    for (std::size_t a = 0; a < used.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const double d =
            (value_of(set, used[a]) - value_of(set, used[b])) / std::sqrt(2.0);
        off.insert(off.end(), {d, -d});  // about zero, not about their own median
        stated +=
            std::pow(error_of(set, used[a]), 2) + std::pow(error_of(set, used[b]), 2);
      }
    }
  }
  if (degrees < kRepeatsMin) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const double spread = robust_standard_deviation(off);
  return std::sqrt(
      std::max(0.0, spread * spread - stated / static_cast<double>(off.size())));
}

// Marks presses far from the others of their place.
void mark_far(const FieldData& set, const std::vector<std::vector<std::size_t>>& places,
              double repeatability, std::vector<char>& far) {
  for (const auto& place : places) {
    const auto used = used_of(set, place);
    if (used.size() < 3 || std::isnan(repeatability)) {
      continue;
    }
    const double middle = median_of(set, used);
    for (const std::size_t i : used) {
      const double sd = std::hypot(error_of(set, i), repeatability);
      far[i] = far[i] != 0 || std::abs(value_of(set, i) - middle) > kFarScore * sd;
    }
  }
}

FieldData joined(const FieldData& set,
                 const std::vector<std::vector<std::size_t>>& places,
                 double repeatability, const std::vector<char>& far) {
  const double own = std::isnan(repeatability) ? 0.0 : repeatability;
  const auto m = std::ssize(places);
  FieldData result{
      Eigen::VectorXd::Constant(m, std::numeric_limits<double>::quiet_NaN()),
      Eigen::VectorXd::Ones(m), std::vector<char>(places.size(), 0)};
  for (std::size_t p = 0; p < places.size(); ++p) {
    // Mean of a place by weights 1 / (sd^2 + repeatability^2), of variance 1 / sum of
    // weights.
    double weights = 0.0, sum = 0.0;
    for (const std::size_t i : used_of(set, places[p])) {
      const double w =
          far[i] != 0 ? 0.0 : 1.0 / (std::pow(error_of(set, i), 2) + own * own);
      weights += w;
      sum += w > 0.0 ? w * value_of(set, i) : 0.0;
    }
    if (weights > 0.0) {
      result.value[static_cast<Eigen::Index>(p)] = sum / weights;
      result.sd[static_cast<Eigen::Index>(p)] = std::sqrt(1.0 / weights);
      result.used[p] = 1;
    }
  }
  return result;
}

}  // namespace

std::vector<std::vector<std::size_t>> places_of(
    std::span<const Eigen::Vector3d> position_m, double apart_m) {
  std::vector<std::vector<std::size_t>> places;
  for (std::size_t i = 0; i < position_m.size(); ++i) {
    const auto same =
        std::find_if(places.begin(), places.end(), [&](const auto& place) {
          return (position_m[place.front()] - position_m[i]).norm() <= apart_m;
        });
    if (same == places.end()) {
      places.push_back({i});
    } else {
      same->push_back(i);
    }
  }
  return places;
}

JoinedPresses join_presses(std::span<const FieldData> data,
                           const std::vector<std::vector<std::size_t>>& places) {
  JoinedPresses result;
  std::vector<char> far(data.empty() ? 0 : data.front().used.size(), 0);
  for (const FieldData& set : data) {
    result.repeatability.push_back(repeatability_of(set, places));
    mark_far(set, places, result.repeatability.back(), far);
  }
  for (std::size_t s = 0; s < data.size(); ++s) {
    result.data.push_back(joined(data[s], places, result.repeatability[s], far));
  }
  for (std::size_t i = 0; i < far.size(); ++i) {
    if (far[i] != 0) {
      result.left_out.push_back(i);
    }
  }
  return result;
}

}  // namespace palpate
