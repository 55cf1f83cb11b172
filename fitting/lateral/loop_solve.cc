#include "fitting/lateral/loop_solve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include <Eigen/QR>

#include "fitting/curve/misfit.h"
#include "fitting/numerics/least_squares.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/quantile.h"

namespace palpate {
namespace {

constexpr std::array kStartReaches{0.003, 0.01, 0.03, 0.1, 0.3};  // x_p over the travel
constexpr std::size_t kStartsTried = 4;
constexpr double kSlipRange = 1e3;   // S at most, over half the range of the forces
constexpr double kReachMin = 1e-3;   // x_p at least, over the median step
constexpr double kFlat = 1e-9;       // [-] derivative that tells nothing
constexpr double kTailShare = 0.02;  // quantiles of the forces for their range

struct ForceRange {
  double low = 0.0, high = 0.0;
};

ForceRange force_range(const LateralPath& path) {
  std::vector<double> sorted = path.force_n;
  std::sort(sorted.begin(), sorted.end());
  return {quantile(sorted, kTailShare), quantile(sorted, 1.0 - kTailShare)};
}

double median_step(const LateralPath& path) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < path.displacement_m.size(); ++i) {
    const double step = std::abs(path.displacement_m[i] - path.displacement_m[i - 1]);
    if (step > 0.0) {
      steps.push_back(step);
    }
  }
  return median(steps);
}

void evaluate_loop(const LateralPath& path, const SolvedLoop& now,
                   const Eigen::VectorXd& q, Eigen::Ref<Eigen::VectorXd> residual,
                   RowMajorMatrix* jacobian) {
  const ContactCurve curve = now.curve(q);
  const auto states = states_along(path, curve, now.zero_m(path, q));
  for (std::size_t row = 0; row < path.fitted.size(); ++row) {
    const std::size_t i = path.fitted[row];
    const FrictionState& state = states[i];
    const double slip = curve.slip_force_n * path.normal_share[i] / now.range_n;
    const auto r = static_cast<Eigen::Index>(row);
    residual[r] = slip * state.share + q[kOffset] + q[kDrift] * path.clock[i] -
                  path.force_n[i] / now.range_n;
    if (jacobian != nullptr) {
      auto slope = jacobian->row(r);
      slope[kLogStiffness] = slip * state.by_log_k;
      slope[kLogSlip] = slip * (state.share + state.by_log_slip);
      slope[kZero] = slip * state.by_zero * path.travel_m;
      slope[kOffset] = 1.0;
      slope[kDrift] = path.clock[i];
    }
  }
}

LeastSquaresProblem loop_problem(const LateralPath& path, const SolvedLoop& now) {
  LeastSquaresProblem problem;
  problem.residuals = static_cast<int>(path.fitted.size());
  problem.in_a_row = problem.residuals;
  problem.evaluate = [&](const Eigen::VectorXd& q, const Eigen::Ref<Eigen::VectorXd>& r,
                         RowMajorMatrix* jacobian) {
    evaluate_loop(path, now, q, r, jacobian);
    return true;
  };
  problem.lower = Eigen::VectorXd::Constant(kLoopParameters, -kInf);
  problem.upper = Eigen::VectorXd::Constant(kLoopParameters, kInf);
  const double slip = 0.5 * now.range_n;
  problem.lower[kLogSlip] = std::log(slip / kSlipRange);
  problem.upper[kLogSlip] = std::log(slip * kSlipRange);
  problem.lower[kLogStiffness] = std::log(slip / path.travel_m / kSlipRange);
  problem.upper[kLogStiffness] =
      std::log(slip / std::min(path.travel_m, kReachMin * median_step(path)));
  problem.held = now.held;
  return problem;
}

// Starts over lengths of presliding, and over contacts that begin at rest, sliding, or
// pressed the other way.
std::vector<Eigen::VectorXd> loop_starts(const LateralPath& path, const SolvedLoop& now,
                                         const ForceRange& range) {
  const bool one_way = path.turn.empty();
  const double slip = (one_way ? 1.0 : 0.5) * (range.high - range.low);
  const double offset = one_way ? path.force_n.front() : 0.5 * (range.high + range.low);
  std::vector<Eigen::VectorXd> starts;
  for (const double reach : kStartReaches) {
    for (const double side : {0.0, -2.0, 2.0}) {
      if (side != 0.0 && now.held[kZero]) {
        continue;
      }
      Eigen::VectorXd q = Eigen::VectorXd::Zero(kLoopParameters);
      q[kLogSlip] = std::log(slip);
      q[kLogStiffness] = std::log(slip / (reach * path.travel_m));
      q[kZero] = path.displacement_m.front() / path.travel_m + side * reach;
      q[kOffset] = offset / now.range_n;
      starts.push_back(q);
    }
  }
  return starts;
}

// The starts that suit best before they are followed.
std::vector<Eigen::VectorXd> best_starts(const LeastSquaresProblem& problem,
                                         std::vector<Eigen::VectorXd> starts) {
  std::vector<std::pair<double, std::size_t>> cost;
  Eigen::VectorXd residual(problem.residuals);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    (void)problem.evaluate(starts[i], residual, nullptr);
    cost.emplace_back(residual.squaredNorm(), i);
  }
  std::sort(cost.begin(), cost.end());
  std::vector<Eigen::VectorXd> best;
  for (std::size_t i = 0; i < std::min(kStartsTried, cost.size()); ++i) {
    best.push_back(starts[cost[i].second]);
  }
  return best;
}

void count_samples(const LateralPath& path, const std::vector<FrictionState>& states,
                   SolvedLoop& now) {
  LoopSamples& counts = now.samples = {};
  for (const std::size_t i : path.fitted) {
    const FrictionState& state = states[i];
    const double way = path.displacement_m[i] - state.from_m;
    if (state.stick_share >= kSlidesShare) {
      ++(way > 0.0 ? counts.slides_up : counts.slides_down);
    } else if (way != 0.0) {
      ++counts.sticks;
    }
  }
}

// Motions that end sliding, and the largest stiffness that they are known to exceed:
// the force changes by 2 S between a turn and the first sample behind it that slides.
void count_motions(const LateralPath& path, const std::vector<FrictionState>& states,
                   SolvedLoop& now) {
  const double slip = now.curve().slip_force_n;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const bool before = i > 0 && states[i - 1].stick_share >= kSlidesShare &&
                        states[i - 1].share * states[i].share > 0.0;
    if (states[i].stick_share < kSlidesShare || before) {
      continue;
    }
    ++now.samples.motions;
    if (!states[i].from_rest) {
      const double way = std::abs(path.displacement_m[i] - states[i].from_m);
      now.stiffest_n_per_m = std::max(now.stiffest_n_per_m, 2.0 * slip / way);
    }
  }
}

// Parameters that no sample tells anything of stay where they are.
void hold_untold(const LateralPath& path, SolvedLoop& now) {
  const bool both_ways =
      now.samples.slides_up >= kLoopPartMin && now.samples.slides_down >= kLoopPartMin;
  now.held[kZero] = !both_ways;
  now.held[kDrift] = path.turn.empty() || (!both_ways && path.turn.size() < 2);
  if (now.held[kZero]) {
    now.q[kZero] = path.displacement_m.front() / path.travel_m;
  }
  if (now.held[kDrift]) {
    now.q[kDrift] = 0.0;
  }
}

void solve_once(const LateralPath& path, const std::vector<Eigen::VectorXd>& starts,
                SolvedLoop& now) {
  const LeastSquaresProblem problem = loop_problem(path, now);
  const LeastSquaresReport report =
      solve_from_starts(problem, best_starts(problem, starts), {.tolerance = 1e-12});
  now.q = report.q;
  now.converged = report.converged;
  const auto states = states_along(path, now.curve(), now.zero_m(path, now.q));
  count_samples(path, states, now);
}

// A contact that begins sliding does not tell where it was at rest.
void hold_flat_zero(const LateralPath& path, SolvedLoop& now) {
  const LeastSquaresProblem problem = loop_problem(path, now);
  RowMajorMatrix jacobian(problem.residuals, kLoopParameters);
  now.residual.resize(problem.residuals);
  (void)problem.evaluate(now.q, now.residual, &jacobian);
  for (const Eigen::Index j : {Eigen::Index{kZero}, Eigen::Index{kLogStiffness}}) {
    const auto at = static_cast<std::size_t>(j);
    now.held[at] = now.held[at] || !(jacobian.col(j).norm() > kFlat);
  }
}

// Residuals of a spring that never slides, b + c t + k x, by linear least squares.
Eigen::VectorXd spring_residual(const LateralPath& path, const SolvedLoop& now,
                                Eigen::Vector3d& line) {
  const auto n = static_cast<Eigen::Index>(path.fitted.size());
  Eigen::MatrixXd J(n, 3);
  Eigen::VectorXd f(n);
  for (Eigen::Index row = 0; row < n; ++row) {
    const std::size_t i = path.fitted[static_cast<std::size_t>(row)];
    const double way = path.displacement_m[i] - path.displacement_m.front();
    J.row(row) << path.normal_share[i] * way / path.travel_m, 1.0,
        path.turn.size() < 2 ? 0.0 : path.clock[i];
    f[row] = path.force_n[i] / now.range_n;
  }
  line = J.completeOrthogonalDecomposition().solve(f);
  return J * line - f;
}

std::span<const double> as_span(const Eigen::VectorXd& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

// Whether slip explains more than noise does of what a mere spring leaves.
bool slip_is_seen(const LateralPath& path, const SolvedLoop& now,
                  const Eigen::VectorXd& spring) {
  if (!(now.residual.squaredNorm() > 0.0)) {
    return spring.squaredNorm() > 0.0;
  }
  std::vector<double> x;
  for (const std::size_t i : path.fitted) {
    x.push_back(path.displacement_m[i]);
  }
  return ResidualNoise(x, as_span(now.residual)).deviance(as_span(spring)) >
         kSlipDeviance;
}

// The contact as a spring whose slip is far away.
void take_spring(const LateralPath& path, const Eigen::Vector3d& line,
                 SolvedLoop& now) {
  const double both = std::max(line[0], 1e-6) * now.range_n / path.travel_m;
  const double k = 1.0 / std::max(1.0 / both - 1.0 / now.instrument_n_per_m,
                                  1.0 / (kSlipRange * both));
  now.held.assign(kLoopParameters, false);
  now.held[kLogSlip] = now.held[kZero] = true;
  now.held[kDrift] = path.turn.size() < 2;
  now.q[kLogStiffness] = std::log(k);
  now.q[kLogSlip] = std::log(0.5 * kSlipRange * now.range_n);
  now.q[kZero] = path.displacement_m.front() / path.travel_m;
  now.q[kOffset] = line[1];
  now.q[kDrift] = now.held[kDrift] ? 0.0 : line[2];
  now.samples.slides_up = now.samples.slides_down = 0;
  now.samples.sticks = path.fitted.size();
}

}  // namespace

ContactCurve SolvedLoop::curve(const Eigen::VectorXd& at) const {
  return {law, std::exp(at[kLogStiffness]), std::exp(at[kLogSlip]), instrument_n_per_m};
}

std::vector<FrictionState> states_along(const LateralPath& path,
                                        const ContactCurve& curve, double zero_m) {
  std::vector<FrictionState> states(path.displacement_m.size());
  FrictionHistory history(curve, zero_m);
  auto turn = path.turn.begin();
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (turn != path.turn.end() && turn->after == i) {
      (void)history.move_to(turn->place_m);
      ++turn;
    }
    states[i] = history.move_to(path.displacement_m[i]);
  }
  return states;
}

SolvedLoop solve_loop(const LateralPath& path, ContactLaw law,
                      double instrument_n_per_m) {
  const ForceRange range = force_range(path);
  SolvedLoop now;
  now.law = law;
  now.instrument_n_per_m = instrument_n_per_m;
  now.range_n = std::max(range.high - range.low, std::numeric_limits<double>::min());
  now.held.assign(kLoopParameters, false);
  now.held[kZero] = now.held[kDrift] = path.turn.empty();
  solve_once(path, loop_starts(path, now, range), now);
  if (const std::vector<bool> before = now.held; !path.turn.empty()) {
    hold_untold(path, now);
    if (now.held != before) {
      solve_once(path, loop_starts(path, now, range), now);
    }
  }
  hold_flat_zero(path, now);
  Eigen::Vector3d line;
  const Eigen::VectorXd spring = spring_residual(path, now, line);
  const bool seen = slip_is_seen(path, now, spring);
  now.slides = seen && now.samples.slides() >= kLoopPartMin;
  if (!seen) {
    take_spring(path, line, now);
    hold_flat_zero(path, now);
  }
  count_motions(path, states_along(path, now.curve(), now.zero_m(path, now.q)), now);
  const LeastSquaresProblem problem = loop_problem(path, now);
  now.endless = at_bound(problem, now.q)[static_cast<std::size_t>(kLogStiffness)];
  now.covariance = least_squares_covariance(problem, now.q);
  return now;
}

}  // namespace palpate
