#include "fitting/lateral/lateral_path.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "fitting/curve/sample_clock.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr std::size_t kRestMin = 5;     // samples of a hold
constexpr double kRestShare = 1e-3;     // [-] of the median step
constexpr std::size_t kSmoothMax = 10;  // samples on either side
constexpr std::size_t kSmoothOneOf = 200;
constexpr std::size_t kFirstForces = 5;
constexpr double kSteady = 0.2;  // [-] of a speed, by which the next may differ

void check_run(const LateralRun& run) {
  const std::size_t n = run.displacement_m.size();
  const auto wrong = [n](const std::vector<double>& values) {
    return !values.empty() && values.size() != n;
  };
  if (run.force_n.size() != n || wrong(run.time_s) || wrong(run.normal_n) ||
      n < kLateralSamplesMin) {
    throw InputError(fmt::format(
        "{} displacements, {} forces, {} times and {} normal forces: need as many of "
        "each and at least {}",
        n, run.force_n.size(), run.time_s.size(), run.normal_n.size(),
        kLateralSamplesMin));
  }
  for (const auto* values :
       {&run.displacement_m, &run.force_n, &run.time_s, &run.normal_n}) {
    const auto bad = std::find_if(values->begin(), values->end(), [](double v) {
      return !std::isfinite(v);
    });
    if (bad != values->end()) {
      throw InputError(fmt::format("sample {} has the value {}, must be finite",
                                   bad - values->begin() + 1, *bad));
    }
  }
  const double stated = run.normal_stated_n;
  if (!std::isnan(stated) && !(stated > 0.0 && std::isfinite(stated))) {
    throw InputError(
        fmt::format("the normal force is {} N, must be above 0 and finite", stated));
  }
}

std::vector<double> part(const std::vector<double>& values, std::size_t begin,
                         std::size_t end) {
  return values.empty()
             ? values
             : std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(begin),
                                   values.begin() + static_cast<std::ptrdiff_t>(end));
}

// Means of neighbours, as many on one side as on the other.
std::vector<double> smoothed(const std::vector<double>& values) {
  const std::size_t n = values.size();
  const std::size_t most = std::min(kSmoothMax, n / kSmoothOneOf);
  std::vector<double> means(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t reach = std::min({most, i, n - 1 - i});
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(i - reach);
    means[i] = std::accumulate(
                   begin, begin + static_cast<std::ptrdiff_t>(2 * reach + 1), 0.0) /
               static_cast<double>(2 * reach + 1);
  }
  return means;
}

// [begin, end) of the samples in contact, by a normal force that is positive there.
std::pair<std::size_t, std::size_t> pressed_samples(const std::vector<double>& normal) {
  const double least = kContactShareMin * median(normal);
  const auto touches = [least](double n) {
    return n >= least;
  };
  const auto first = std::find_if(normal.begin(), normal.end(), touches);
  const auto last = std::find_if(normal.rbegin(), normal.rend(), touches);
  return {static_cast<std::size_t>(first - normal.begin()),
          static_cast<std::size_t>(last.base() - normal.begin())};
}

void take_normal_force(const LateralRun& run, std::size_t begin, std::size_t end,
                       double sign, LateralPath& path) {
  if (run.normal_n.empty()) {
    path.normal_n = run.normal_stated_n;
    path.normal_share.assign(end - begin, 1.0);
    return;
  }
  path.normal_share = part(run.normal_n, begin, end);
  // The mean along the way: where nothing moves the normal force matters little.
  double way = 0.0, sum = 0.0;
  for (std::size_t i = 1; i < path.displacement_m.size(); ++i) {
    const double step = std::abs(path.displacement_m[i] - path.displacement_m[i - 1]);
    way += step;
    sum += step * sign * path.normal_share[i];
  }
  path.normal_n = sum / way;
  path.normal_share = smoothed(path.normal_share);
  for (double& share : path.normal_share) {
    share *= sign / path.normal_n;
  }
  const auto [low, high] =
      std::minmax_element(path.normal_share.begin(), path.normal_share.end());
  if (!(*low >= kNormalShareMin)) {
    throw InputError(fmt::format(
        "the normal force goes from {:.4g} to {:.4g} N: while it is held it must stay "
        "above {} of its mean",
        *low * path.normal_n, *high * path.normal_n, kNormalShareMin));
  }
}

// Displacement per clock from sample i to the next.
double speed_at(const LateralPath& path, std::size_t i) {
  return (path.displacement_m[i + 1] - path.displacement_m[i]) /
         (path.clock[i + 1] - path.clock[i]);
}

// Where lines through samples before (to i) and behind (from i + 1) meet, if that is
// between i and i + 1 and the speed is steady on either side.
std::optional<double> meeting_place(const LateralPath& path, std::size_t i) {
  const auto& x = path.displacement_m;
  const auto& t = path.clock;
  if (i < 2 || i + 3 >= x.size()) {
    return std::nullopt;
  }
  const double before = speed_at(path, i - 1), behind = speed_at(path, i + 1);
  const auto steady = [](double speed, double farther) {
    return std::abs(speed - farther) <= kSteady * std::abs(farther);
  };
  if (!(before * behind < 0.0) || !steady(before, speed_at(path, i - 2)) ||
      !steady(behind, speed_at(path, i + 2))) {
    return std::nullopt;
  }
  const double at =
      (x[i + 1] - behind * t[i + 1] - x[i] + before * t[i]) / (before - behind);
  return t[i] <= at && at <= t[i + 1] ? std::optional(x[i] + before * (at - t[i]))
                                      : std::nullopt;
}

// Top of the parabola through sample i and its neighbours, i the extreme one of them.
// With speeds v, w on either side and half-way clocks h apart the motion stands where
// v + (w - v) s / h is 0.
LateralTurn parabola_turn(const LateralPath& path, std::size_t i) {
  const auto& x = path.displacement_m;
  const auto& t = path.clock;
  if (i < 1 || i + 1 >= x.size() || !(t[i] > t[i - 1]) || !(t[i + 1] > t[i])) {
    return {i + 1, x[i]};
  }
  const double v = speed_at(path, i - 1), w = speed_at(path, i);
  const double before = 0.5 * (t[i] - t[i - 1]), behind = 0.5 * (t[i + 1] - t[i]);
  if (!(v * w < 0.0)) {
    return {i + 1, x[i]};
  }
  const double s = v / (v - w) * (before + behind) - before;  // clock from sample i on
  const double at_i = v + (w - v) * before / (before + behind);
  return {s > 0.0 ? i + 1 : i, x[i] + 0.5 * at_i * s};
}

// A turn near the extreme sample, which may be the last before it or the first behind.
LateralTurn turn_at(const LateralPath& path, std::size_t extreme) {
  const auto behind = meeting_place(path, extreme);
  const auto before = meeting_place(path, extreme - std::min(extreme, std::size_t{1}));
  const double x = path.displacement_m[extreme];
  const auto beyond = [x](const std::optional<double>& place) {
    return std::abs(place.value_or(x) - x);
  };
  if (!behind && !before) {
    return parabola_turn(path, extreme);
  }
  return beyond(behind) >= beyond(before) ? LateralTurn{extreme + 1, behind.value_or(x)}
                                          : LateralTurn{extreme, before.value_or(x)};
}

std::vector<LateralTurn> find_turns(const LateralPath& path) {
  const auto& x = path.displacement_m;
  const double least = kTurnShareMin * path.travel_m;
  std::vector<LateralTurn> turns;
  std::size_t low = 0, high = 0;
  int direction = 0;  // of the motion; 0: not known yet
  for (std::size_t i = 1; i < x.size(); ++i) {
    low = x[i] < x[low] ? i : low;
    high = x[i] > x[high] ? i : high;
    if (direction >= 0 && x[high] - x[i] >= least) {
      if (direction > 0) {
        turns.push_back(turn_at(path, high));
      }
      direction = -1;
      low = i;
    } else if (direction <= 0 && x[i] - x[low] >= least) {
      if (direction < 0) {
        turns.push_back(turn_at(path, low));
      }
      direction = 1;
      high = i;
    }
  }
  return turns;
}

// All but holds; a hold before the first motion tells the force without displacement.
std::vector<std::size_t> fitted_samples(const std::vector<double>& x) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < x.size(); ++i) {
    if (x[i] != x[i - 1]) {
      steps.push_back(std::abs(x[i] - x[i - 1]));
    }
  }
  const double still = kRestShare * median(steps);
  std::vector<std::size_t> fitted;
  bool moved = false;
  for (std::size_t i = 0; i < x.size();) {
    std::size_t end = i + 1;
    while (end < x.size() && std::abs(x[end] - x[i]) <= still) {
      ++end;
    }
    const bool hold = moved && end - i >= kRestMin;
    for (std::size_t j = i; j < (hold ? i + 1 : end); ++j) {
      fitted.push_back(j);
    }
    moved = true;
    i = end;
  }
  return fitted;
}

// Friction takes work, and a spring's force rises with the displacement. Both have the
// sign of the force: work over the force at the beginning as a share of the most that
// the forces' range allows, and correlation.
double sign_of_tangential(const LateralPath& path) {
  const auto& x = path.displacement_m;
  const auto& f = path.force_n;
  const double before = median(part(f, 0, kFirstForces));
  const auto n = static_cast<double>(x.size());
  const double mean_x = std::accumulate(x.begin(), x.end(), 0.0) / n;
  const double mean_f = std::accumulate(f.begin(), f.end(), 0.0) / n;
  double work = 0.0, way = 0.0, xx = 0.0, xf = 0.0, ff = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double step = i == 0 ? 0.0 : x[i] - x[i - 1];
    work += i == 0 ? 0.0 : (0.5 * (f[i] + f[i - 1]) - before) * step;
    way += std::abs(step);
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xf += (x[i] - mean_x) * (f[i] - mean_f);
    ff += (f[i] - mean_f) * (f[i] - mean_f);
  }
  return work / (0.5 * extent(f) * way) + xf / std::sqrt(xx * ff) < 0.0 ? -1.0 : 1.0;
}

}  // namespace

LateralPath find_lateral_path(const LateralRun& run) {
  check_run(run);
  std::size_t begin = 0, end = run.force_n.size();
  double sign = 1.0;
  if (!run.normal_n.empty()) {
    std::vector<double> normal = run.normal_n;
    sign = median(normal) < 0.0 ? -1.0 : 1.0;
    for (double& n : normal) {
      n *= sign;
    }
    std::tie(begin, end) = pressed_samples(normal);
  }
  LateralPath path;
  path.first = begin;
  path.apart = run.force_n.size() - (end - begin);
  path.displacement_m = part(run.displacement_m, begin, end);
  path.force_n = part(run.force_n, begin, end);
  path.travel_m = end > begin ? extent(path.displacement_m) : 0.0;
  if (end - begin < kLateralSamplesMin) {
    throw InputError(fmt::format("{} samples in contact, need at least {}", end - begin,
                                 kLateralSamplesMin));
  }
  if (!(path.travel_m > 0.0)) {
    throw InputError("the contact does not move sideways");
  }
  if (!(extent(path.force_n) > 0.0)) {
    throw InputError("the tangential force does not change");
  }
  take_normal_force(run, begin, end, sign, path);
  path.clock = sample_clock(part(run.time_s, begin, end), end - begin);
  path.turn = find_turns(path);
  path.fitted = fitted_samples(path.displacement_m);
  if (sign_of_tangential(path) < 0.0) {
    path.force_turned = true;
    std::transform(path.force_n.begin(), path.force_n.end(), path.force_n.begin(),
                   std::negate<>());
  }
  return path;
}

}  // namespace palpate
