#include "fitting/lateral/loop_loss.h"

#include <algorithm>
#include <cmath>

#include "fitting/numerics/correlated_noise.h"

namespace palpate {
namespace {

constexpr double kBriefShare = 0.05;  // [-] of a cycle
constexpr int kPieces = 8;            // between samples

// An end of the path or a turn: state of the contact and work until there.
struct Extreme {
  std::size_t after = 0;  // first sample behind it
  double place_m = 0.0, share = 0.0, work_j = 0.0;
};

// Follows the contact through samples and turns, and sums the work.
class WorkMeter {
 public:
  WorkMeter(const ContactCurve& curve, double zero_m, double start_m)
      : slip_n_(curve.slip_force_n), history_(curve, zero_m), place_m_(start_m) {
    share_ = history_.move_to(start_m).share;
  }

  // @param normal_share at the place.
  void move_to(double place_m, double normal_share) {
    const double step = (place_m - place_m_) / kPieces;
    for (int i = 1; i <= kPieces; ++i) {
      const double before = share_;
      share_ = history_.move_to(i < kPieces ? place_m_ + i * step : place_m).share;
      work_j_ += slip_n_ * normal_share * 0.5 * (before + share_) * step;
    }
    place_m_ = place_m;
  }
  [[nodiscard]] Extreme extreme(std::size_t after) const {
    return {after, place_m_, share_, work_j_};
  }

 private:
  double slip_n_;
  FrictionHistory history_;
  double place_m_, share_ = 0.0, work_j_ = 0.0;
};

std::vector<Extreme> extremes_of(const LateralPath& path, const SolvedLoop& solved) {
  const auto& x = path.displacement_m;
  WorkMeter meter(solved.curve(), solved.zero_m(path, solved.q), x.front());
  std::vector<Extreme> extremes{meter.extreme(1)};
  auto turn = path.turn.begin();
  for (std::size_t i = 1; i < x.size(); ++i) {
    if (turn != path.turn.end() && turn->after == i) {
      meter.move_to(turn->place_m, path.normal_share[i]);
      extremes.push_back(meter.extreme(i));
      ++turn;
    }
    meter.move_to(x[i], path.normal_share[i]);
  }
  extremes.push_back(meter.extreme(x.size()));
  return extremes;
}

bool is_closed(const Extreme& from, const Extreme& over, const Extreme& to) {
  const double width = std::abs(over.place_m - from.place_m);
  return std::abs(to.place_m - from.place_m) <= kClosedShare * width &&
         std::abs(to.share - from.share) <= kClosedShare;
}

// (fitted) du_i of samples in a cycle: half the way from the place before to the place
// behind, through turns.
Eigen::VectorXd steps_within(const LateralPath& path, const Extreme& from,
                             const Extreme& to) {
  const auto& x = path.displacement_m;
  std::vector<double> ways(x.size(), 0.0);
  auto turn = path.turn.begin();
  for (std::size_t i = 1; i < x.size(); ++i) {
    const bool turns = turn != path.turn.end() && turn->after == i;
    const double middle = turns ? turn->place_m : 0.5 * (x[i - 1] + x[i]);
    turn += turns ? 1 : 0;
    if (i > from.after && i < to.after) {
      ways[i - 1] += middle - x[i - 1];
      ways[i] += x[i] - middle;
    } else if (i == from.after) {
      ways[i] += x[i] - from.place_m;
    } else if (i == to.after) {
      ways[i - 1] += to.place_m - x[i - 1];
    }
  }
  Eigen::VectorXd steps(static_cast<Eigen::Index>(path.fitted.size()));
  for (std::size_t row = 0; row < path.fitted.size(); ++row) {
    steps[static_cast<Eigen::Index>(row)] = ways[path.fitted[row]];
  }
  return steps;
}

double spread_j(const std::vector<ProbableNoise>& noises, const Eigen::VectorXd& steps,
                double unit_n) {
  double variance = 0.0;
  for (const auto& [noise, weight] : noises) {
    variance += weight * steps.dot(times_covariance(noise, steps).col(0));
  }
  return unit_n * std::sqrt(std::max(0.0, variance));
}

}  // namespace

LoopLosses loop_losses(const LateralPath& path, const SolvedLoop& solved) {
  LoopLosses losses;
  const std::vector<Extreme> extremes = extremes_of(path, solved);
  const auto noises =
      noises_of(Eigen::MatrixXd(solved.residual.size(), 0), solved.residual);
  // What changes from cycle to cycle is no noise: for that neighbours share little.
  const double cycle = static_cast<double>(path.fitted.size()) /
                       std::max(1.0, 0.5 * static_cast<double>(path.turn.size()));
  const auto brief =
      noises_of(Eigen::MatrixXd(solved.residual.size(), 0), solved.residual,
                SharedNoise::kRough, std::max(1.0, kBriefShare * cycle));
  Eigen::VectorXd all = Eigen::VectorXd::Zero(solved.residual.size());
  double weights = 0.0, weighed = 0.0, squares = 0.0;
  for (std::size_t j = 0; j + 2 < extremes.size();) {
    const Extreme &from = extremes[j], &over = extremes[j + 1], &to = extremes[j + 2];
    if (!is_closed(from, over, to)) {
      ++j;
      continue;
    }
    j += 2;
    const Eigen::VectorXd steps = steps_within(path, from, to);
    all += steps;
    const double more = -solved.range_n * steps.dot(solved.residual);
    const double modelled = to.work_j - from.work_j;
    const double sd = spread_j(noises, steps, solved.range_n);
    losses.cycle.push_back(
        {0.5 * std::abs(over.place_m - from.place_m), modelled + more, modelled, sd});
    const double short_sd = spread_j(brief, steps, solved.range_n);
    const double weight = short_sd > 0.0 ? 1.0 / (short_sd * short_sd) : 0.0;
    weights += weight;
    weighed += weight * more;
    squares += weight * more * more;
  }
  const auto count = static_cast<double>(losses.cycle.size());
  losses.mean_sd_j = count > 0.0 ? spread_j(noises, all, solved.range_n) / count : 0.0;
  losses.chi_squared = weights > 0.0 ? squares - weighed * weighed / weights : 0.0;
  return losses;
}

}  // namespace palpate
