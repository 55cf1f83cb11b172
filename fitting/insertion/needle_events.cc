#include "fitting/insertion/needle_events.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "fitting/insertion/force_falls.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kChi95 = 3.841459;    // quantile of chi squared, one degree
constexpr std::size_t kMoveReach = 6;  // samples

int ruptures_before(const NeedleSwitches& switches, std::size_t i) {
  return static_cast<int>(std::count_if(
      switches.ruptures.begin(), switches.ruptures.end(), [&](const RuptureSamples& r) {
        return r.after <= i;
      }));
}

// Whether the force falls at an insertion's sample, or its friction lags afterwards.
bool falls_there(const NeedlePath& path, const NeedleSwitches& switches,
                 std::size_t i) {
  return std::any_of(
      switches.ruptures.begin(), switches.ruptures.end(), [&](const RuptureSamples& r) {
        const bool lags =
            i >= r.after && path.depth_m[i] - path.depth_m[r.after] < r.lag_m;
        return r.before < i && (i < r.after || lags);
      });
}

// Samples of this motion in a pass.
std::vector<std::size_t> moving_samples(const NeedlePath& path, std::size_t begin,
                                        std::size_t end, NeedleMotion motion) {
  std::vector<std::size_t> places;
  for (std::size_t i = begin; i < end; ++i) {
    if (path.motion[i] == motion) {
      places.push_back(i);
    }
  }
  return places;
}

// Squares that a straight line leaves of values, one more at a time.
struct StraightLine {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;

  void add(double at, double value) {
    n += 1.0;
    x += at;
    y += value;
    xx += at * at;
    xy += at * value;
    yy += value * value;
  }
  [[nodiscard]] double slope() const {
    const double spread = xx - x * x / n;
    return spread > 1e-12 * xx ? (xy - x * y / n) / spread : 0.0;
  }
  [[nodiscard]] double at(double place) const {
    return y / n + slope() * (place - x / n);
  }
  [[nodiscard]] double squares_left() const {
    return std::max(0.0, yy - y * y / n - slope() * (xy - x * y / n));
  }
};

NeedleSample sample_at(const NeedlePath& path, std::size_t i, std::size_t pass,
                       int ruptures, ShaftState shaft) {
  return {.depth_m = path.depth_m[i],
          .clock = path.clock[i],
          .file = path.file[i],
          .pass = static_cast<int>(pass),
          .ruptures = ruptures,
          .shaft = shaft};
}

}  // namespace

std::vector<RuptureSamples> find_ruptures(const NeedlePath& path) {
  std::vector<RuptureSamples> ruptures;
  double deepest = -std::numeric_limits<double>::infinity();
  for (const NeedlePass& pass : path.pass) {
    std::vector<std::size_t> places;
    std::vector<double> force;
    for (const std::size_t i :
         moving_samples(path, pass.in_begin, pass.in_end, NeedleMotion::kIn)) {
      if (path.depth_m[i] > deepest) {
        places.push_back(i);
        force.push_back(path.force_n[i]);
      }
    }
    for (const ForceFall& fall : find_force_falls(force)) {
      const std::size_t before = places[fall.before], after = places[fall.after];
      ruptures.push_back({before, after, before, after, 0.0});
    }
    deepest = std::max(deepest, pass.turn_m);
  }
  if (ruptures.size() > kRupturesMax) {
    throw InputError(fmt::format(
        "the force falls suddenly {} times, as stick-slip makes it fall; at "
        "most {} ruptures can be fitted",
        ruptures.size(), kRupturesMax));
  }
  return ruptures;
}

FittedSamples fitted_samples(const NeedlePath& path, const NeedleSwitches& switches,
                             double contact_m) {
  FittedSamples fitted;
  const auto add = [&](std::size_t i, std::size_t pass, ShaftState shaft) {
    fitted.sample.push_back(
        sample_at(path, i, pass, ruptures_before(switches, i), shaft));
    fitted.force_n.push_back(path.force_n[i]);
    fitted.place.push_back(i);
  };
  for (std::size_t p = 0; p < path.pass.size(); ++p) {
    const NeedlePass& pass = path.pass[p];
    const bool reverses = p > 0 && pass.first_m > contact_m;
    const double skip_in =
        reverses ? kReversalShare * (path.pass[p - 1].turn_m - pass.first_m) : -1.0;
    for (const std::size_t i :
         moving_samples(path, pass.in_begin, pass.in_end, NeedleMotion::kIn)) {
      if (path.depth_m[i] - pass.first_m > skip_in && !falls_there(path, switches, i)) {
        add(i, p, ShaftState::kInwards);
      }
    }
    const StuckSamples& stuck = switches.stuck[p];
    const double skip_out =
        kReversalShare * (pass.turn_m - std::max(contact_m, pass.last_m));
    std::size_t number = 0;
    for (const std::size_t i :
         moving_samples(path, pass.out_begin, pass.out_end, NeedleMotion::kOut)) {
      const bool known = stuck.count != StuckSamples::kUnknown;
      if (known && number++ < stuck.count) {
        if (stuck.count >= kNeedlePartMin) {
          add(i, p, ShaftState::kSticks);
        }
      } else if (known || pass.turn_m - path.depth_m[i] > skip_out) {
        add(i, p, ShaftState::kOutwards);
      }
    }
  }
  return fitted;
}

NeedleEvents needle_events(const NeedlePath& path, const NeedleSwitches& switches,
                           double reference_m) {
  NeedleEvents events{.ruptures = static_cast<int>(switches.ruptures.size()),
                      .files = path.files,
                      .reference_m = reference_m,
                      .turn_m = {},
                      .turn_ruptures = {}};
  for (const NeedlePass& pass : path.pass) {
    events.turn_m.push_back(pass.turn_m);
    events.turn_ruptures.push_back(ruptures_before(switches, pass.in_end - 1));
  }
  return events;
}

bool move_ruptures(const NeedlePath& path, const NeedleModel& model,
                   const Eigen::VectorXd& q, double variance,
                   NeedleSwitches& switches) {
  const std::vector<NeedleTerm> ends = model.channels(q);
  bool moved = false;
  for (std::size_t k = 0; k < switches.ruptures.size(); ++k) {
    RuptureSamples& rupture = switches.ruptures[k];
    const auto pass =
        static_cast<std::size_t>(std::find_if(path.pass.begin(), path.pass.end(),
                                              [&](const NeedlePass& one) {
                                                return rupture.before >= one.in_begin &&
                                                       rupture.after < one.in_end;
                                              }) -
                                 path.pass.begin());
    const std::size_t width = rupture.after - rupture.before;
    const std::size_t begin =
        std::max(path.pass[pass].in_begin,
                 rupture.before > kMoveReach ? rupture.before - kMoveReach : 0);
    const std::size_t end =
        std::min(rupture.after + kMoveReach + 1, path.pass[pass].in_end);
    const auto squares = [&](std::size_t i, int ruptures) {
      const NeedleSample sample =
          sample_at(path, i, pass, ruptures, ShaftState::kInwards);
      const double miss = model.force(q, sample, ends).value - path.force_n[i];
      return miss * miss;
    };
    // Cost of a rupture after sample i, over [begin, end).
    const auto cost = [&](std::size_t before) {
      double sum = 0.0;
      for (std::size_t i = begin; i < end; ++i) {
        const bool between = i > before && i < before + width;
        sum +=
            between ? variance : squares(i, static_cast<int>(i <= before ? k : k + 1));
      }
      return sum;
    };
    std::size_t best = rupture.before;
    std::vector<double> costs;
    for (std::size_t i = begin; i + width < end; ++i) {
      costs.push_back(cost(i));
      best = costs.back() < costs[best >= begin ? best - begin : 0] ? i : best;
    }
    best = begin + static_cast<std::size_t>(
                       std::min_element(costs.begin(), costs.end()) - costs.begin());
    moved = moved || best != rupture.before;
    const double allowed = costs[best - begin] + kChi95 * variance;
    rupture = {best, best + width, best, best + width, rupture.lag_m};
    for (std::size_t i = 0; i < costs.size(); ++i) {
      if (costs[i] <= allowed) {
        rupture.earliest = std::min(rupture.earliest, begin + i);
        rupture.latest = std::max(rupture.latest, begin + i + width);
      }
    }
  }
  return moved;
}

std::vector<StuckSamples> find_stuck_samples(const NeedlePath& path,
                                             const NeedleModel& model,
                                             const Eigen::VectorXd& q, double variance,
                                             double least_gain) {
  const std::vector<NeedleTerm> ends = model.channels(q);
  std::vector<StuckSamples> stuck(path.pass.size());
  for (std::size_t p = 0; p < path.pass.size(); ++p) {
    const NeedlePass& pass = path.pass[p];
    const auto places =
        moving_samples(path, pass.out_begin, pass.out_end, NeedleMotion::kOut);
    if (places.size() < 2 * kNeedlePartMin) {
      continue;
    }
    Eigen::VectorXd with_line = q;  // sticks with k_b = 0: what the line leaves
    with_line[NeedleModel::kPresliding] = 0.0;
    std::vector<double> line(places.size()), way(places.size()), slid(places.size());
    double total = 0.0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto miss = [&](ShaftState shaft) {
        const NeedleSample sample = sample_at(path, places[i], p, 0, shaft);
        return path.force_n[places[i]] - model.force(with_line, sample, ends).value;
      };
      line[i] = miss(ShaftState::kSticks);
      slid[i] = miss(ShaftState::kOutwards);
      way[i] = pass.turn_m - path.depth_m[places[i]];
      total += slid[i] * slid[i];
    }
    std::vector<double> costs{total};
    StraightLine through;
    for (std::size_t i = 0; i < places.size(); ++i) {
      total -= slid[i] * slid[i];
      through.add(way[i], line[i]);
      // A line that ends above the force of sliding is none of sticking.
      const double kinetic = line[i] - slid[i];
      const bool peaks = through.at(way[i]) < kinetic + 2.0 * std::sqrt(variance);
      costs.push_back(peaks ? total + through.squares_left()
                            : std::numeric_limits<double>::infinity());
    }
    auto best = std::min_element(costs.begin(), costs.end());
    const auto few = costs.begin() + static_cast<std::ptrdiff_t>(kNeedlePartMin);
    const auto best_of_few = std::min_element(costs.begin(), few);
    best = *best < *best_of_few - least_gain ? best : best_of_few;
    const double allowed = *best + kChi95 * variance;
    const auto plausible = [&](double cost) {
      return cost <= allowed;
    };
    stuck[p].count = static_cast<std::size_t>(best - costs.begin());
    stuck[p].least = static_cast<std::size_t>(
        std::find_if(costs.begin(), costs.end(), plausible) - costs.begin());
    stuck[p].most = static_cast<std::size_t>(
        costs.rend() - std::find_if(costs.rbegin(), costs.rend(), plausible) - 1);
  }
  return stuck;
}

}  // namespace palpate
