#include "fitting/curve/time_effects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "fitting/curve/segments.h"
#include "fitting/numerics/least_squares.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kFreeTravel = 0.05;       // [-] of the travel
constexpr double kNewPress = 0.01;         // [-] of the travel: a new press
constexpr double kForceLeft = 1.0 / 30.0;  // [-] of the largest force

// q: g_inf, g_1, g_2 in units of the first force, ln of the times in units of the hold.
LeastSquaresProblem relaxation_problem(const std::vector<double>& t,
                                       const std::vector<double>& f) {
  LeastSquaresProblem problem;
  problem.residuals = static_cast<int>(t.size());
  problem.lower = Eigen::VectorXd::Zero(5);
  problem.upper = Eigen::VectorXd::Constant(5, kInf);
  problem.lower.tail<2>().setConstant(std::log(1e-4));
  problem.upper.tail<2>().setConstant(std::log(10.0));
  problem.evaluate = [&t, &f](const Eigen::VectorXd& q, Eigen::Ref<Eigen::VectorXd> r,
                              RowMajorMatrix* jacobian) {
    for (std::size_t i = 0; i < t.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const double u1 = t[i] / std::exp(q[3]), u2 = t[i] / std::exp(q[4]);
      const double e1 = std::exp(-u1), e2 = std::exp(-u2);
      r[row] = q[0] + q[1] * e1 + q[2] * e2 - f[i];
      if (jacobian != nullptr) {
        jacobian->row(row) << 1.0, e1, e2, q[1] * e1 * u1, q[2] * e2 * u2;
      }
    }
    return true;
  };
  return problem;
}

// Samples in contact: depth, speed of pressing, force above the baseline.
struct Motion {
  std::vector<double> depth_m, speed_m_per_s, force_n;
};

Motion motion_in_contact(const Measurement& m, const ContactFit& fit) {
  Motion motion;
  const std::size_t n = m.depth_m.size();
  const std::size_t reach = std::max<std::size_t>(1, n / 200);
  for (std::size_t i = reach; i + reach < n; ++i) {
    const double d = m.depth_m[i] - fit.contact_point_m;
    const double seconds = m.time_s[i + reach] - m.time_s[i - reach];
    if (d > 0.0 && seconds > 0.0) {
      motion.depth_m.push_back(d);
      motion.speed_m_per_s.push_back((m.depth_m[i + reach] - m.depth_m[i - reach]) /
                                     seconds);
      motion.force_n.push_back(m.force_n[i] - fit.parameters[0].value -
                               fit.parameters[1].value * m.depth_m[i]);
    }
  }
  return motion;
}

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double value : values) {
    most = std::max(most, std::abs(value));
  }
  return most;
}

// q: force at full depth, exponent, lambda in units of the fastest speed.
void fit_hunt_crossley(const Motion& motion, const ContactFit& fit, LoopFit& loop) {
  // F = K d^p (1 + lambda v) (Hunt, Crossley 1975), with d / D, v / V and F / F_max.
  const double D = largest(motion.depth_m), V = largest(motion.speed_m_per_s);
  const double F = largest(motion.force_n);
  if (motion.depth_m.size() < kHoldSamplesMin || !(V > 0.0) || !(F > 0.0)) {
    loop.refused = "too few samples in contact";
    return;
  }
  LeastSquaresProblem problem;
  problem.residuals = static_cast<int>(motion.depth_m.size());
  problem.lower = Eigen::Vector3d(0.0, 0.5, 0.0);
  problem.upper = Eigen::Vector3d(kInf, 5.0, 10.0);
  problem.evaluate = [&](const Eigen::VectorXd& q, Eigen::Ref<Eigen::VectorXd> r,
                         RowMajorMatrix* jacobian) {
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double log_d = std::log(motion.depth_m[k] / D);
      const double power = std::exp(q[1] * log_d);
      const double v = motion.speed_m_per_s[k] / V, damped = 1.0 + q[2] * v;
      r[i] = q[0] * power * damped - motion.force_n[k] / F;
      if (jacobian != nullptr) {
        jacobian->row(i) << power * damped, q[0] * power * damped * log_d,
            q[0] * power * v;
      }
    }
    return true;
  };
  const auto report = solve_from_starts(
      problem,
      {Eigen::Vector3d(0.8, fit.exponent, 0.05), Eigen::Vector3d(0.8, 1.5, 0.5)});
  const Eigen::MatrixXd covariance = least_squares_covariance(problem, report.q);
  if (!report.converged) {
    loop.refused = "the fit did not converge";
    return;
  }
  loop.exponent = report.q[1];
  loop.coefficient = report.q[0] * F / std::pow(D, loop.exponent);
  loop.lambda_s_per_m = report.q[2] / V;
  loop.lambda_sd_s_per_m = std::sqrt(covariance(2, 2)) / V;
  loop.rms_n = F * std::sqrt(2.0 * report.cost / problem.residuals);
}

// Mean speed from half the travel before sample `end` until there, while not held.
double press_speed_m_per_s(const std::vector<double>& x, const std::vector<double>& t,
                           const std::vector<Segment>& segments, std::size_t end) {
  const auto last = x.begin() + static_cast<std::ptrdiff_t>(end);
  const double half = 0.5 * (*std::min_element(x.begin(), last + 1) + *last);
  std::size_t begin = end;
  while (begin > 0 && x[begin] > half) {
    --begin;
  }
  const double travel = x[end] - x[begin];
  double seconds = t[end] - t[begin];
  for (const Segment& s : segments) {
    if (s.kind == SegmentKind::kHold && s.end <= end && s.end > begin) {
      seconds -= t[s.end - 1] - t[std::max(s.begin, begin)];
    }
  }
  return travel > 0.0 && seconds > 0.0 ? travel / seconds
                                       : std::numeric_limits<double>::quiet_NaN();
}

// First sample of the press that leads to sample `end`: that where the tool was last
// free, with what is free before it.
std::size_t press_begin(const std::vector<double>& x, std::size_t end) {
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  const double shallow = *low + kFreeTravel * (*high - *low);
  std::size_t begin = end;
  while (begin > 0 && x[begin] > shallow) {
    --begin;
  }
  while (begin > 0 && x[begin - 1] <= shallow) {
    --begin;
  }
  return begin;
}

// One past the last sample from `begin` on that is surely in contact: of the release,
// and of all that is before `holds_end`.
std::size_t release_end(const std::vector<double>& x, const std::vector<double>& force,
                        std::size_t begin, std::size_t holds_end) {
  const double turn = kNewPress * (*std::max_element(x.begin(), x.end()) -
                                   *std::min_element(x.begin(), x.end()));
  const double most = *std::max_element(force.begin(), force.end());
  double lowest = begin < x.size() ? x[begin] : 0.0;
  std::size_t end = begin;
  while (end < x.size() && force[end] > kForceLeft * most &&
         (end < holds_end || x[end] <= lowest + turn)) {
    lowest = end < holds_end ? x[end] : std::min(lowest, x[end]);
    ++end;
  }
  return end;
}

std::size_t samples_of(const Segment& segment) {
  return segment.end - segment.begin;
}

bool is_hold(const Segment& segment) {
  return segment.kind == SegmentKind::kHold;
}

// A hold, and its largest force: before that the tip still moves.
struct FallingHold {
  Segment segment;
  std::size_t peak = 0;
};

// The hold in which the force falls for longest.
FallingHold longest_fall(const std::vector<Segment>& segments,
                         const std::vector<double>& force_n) {
  FallingHold longest;
  for (const Segment& s : segments) {
    if (!is_hold(s) || samples_of(s) < kHoldSamplesMin) {
      continue;
    }
    const auto first = force_n.begin();
    const auto peak = static_cast<std::size_t>(
        std::max_element(first + static_cast<std::ptrdiff_t>(s.begin),
                         first + static_cast<std::ptrdiff_t>(s.end),
                         [](double a, double b) {
                           return std::abs(a) < std::abs(b);
                         }) -
        first);
    if (longest.segment.end == 0 || s.end - peak > longest.segment.end - longest.peak) {
      longest = {s, peak};
    }
  }
  return longest;
}

// The last hold after another before the tool goes back, which tells as much.
Segment last_of_ascent(const std::vector<Segment>& segments, Segment hold) {
  for (const Segment& s : segments) {
    if (s.begin < hold.end || s.kind == SegmentKind::kApproach) {
      continue;
    }
    if (!is_hold(s)) {
      break;
    }
    hold = samples_of(s) >= kHoldSamplesMin ? s : hold;
  }
  return hold;
}

// @param x displacement, compression positive. @param longest hold
JointRelaxation joint_relaxation(const Measurement& m, const std::vector<double>& x,
                                 const std::vector<Segment>& segments,
                                 const Segment& longest) {
  const Segment hold = last_of_ascent(segments, longest);
  std::size_t holds_end = hold.end;
  for (const Segment& s : segments) {
    holds_end = is_hold(s) ? std::max(holds_end, s.end) : holds_end;
  }
  std::vector<double> force = m.force_n;
  const std::size_t begin = press_begin(x, longest.begin);
  if (force[hold.begin] < force[begin]) {
    for (double& value : force) {
      value = -value;
    }
  }
  const std::size_t end = release_end(x, force, hold.end, holds_end);
  const auto part = [&](const std::vector<double>& values) {
    return std::span(values).subspan(begin, end - begin);
  };
  return fit_press_and_hold(
      {part(m.time_s), part(x), part(force), hold.begin - begin, hold.end - begin});
}

}  // namespace

Relaxation fit_relaxation(std::span<const double> time_s,
                          std::span<const double> force_n) {
  if (time_s.size() != force_n.size() || time_s.size() < kHoldSamplesMin) {
    throw InputError(
        fmt::format("a hold has {} times and {} forces, need as many of both and at "
                    "least {}",
                    time_s.size(), force_n.size(), kHoldSamplesMin));
  }
  Relaxation result;
  result.seconds = time_s.back() - time_s.front();
  if (!(result.seconds > 0.0) || force_n.front() == 0.0) {
    result.refused = "the time or the force of the hold is constant or zero";
    return result;
  }
  std::vector<double> t, f;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    t.push_back((time_s[i] - time_s.front()) / result.seconds);
    f.push_back(force_n[i] / force_n.front());
  }
  result.end_over_start = f.back();
  // f = q0 + q1 exp(-t / tau1) + q2 exp(-t / tau2), t over the hold, f over the first
  // force.
  const LeastSquaresProblem problem = relaxation_problem(t, f);
  std::vector<Eigen::VectorXd> starts;
  const double drop = std::max(0.0, 1.0 - f.back());
  for (const auto& [fast, slow] :
       {std::pair{0.03, 0.3}, std::pair{0.1, 1.0}, std::pair{0.005, 0.1}}) {
    Eigen::VectorXd q(5);
    q << f.back(), 0.5 * drop, 0.5 * drop, std::log(fast), std::log(slow);
    starts.push_back(q);
  }
  LeastSquaresOptions options;
  options.tolerance = 1e-12;
  auto report = solve_from_starts(problem, starts, options);
  const Eigen::MatrixXd covariance = least_squares_covariance(problem, report.q);
  // Shares of the sum at t = 0, the faster term first.
  const int first = report.q[3] <= report.q[4] ? 0 : 1;
  const double start = report.q.head<3>().sum();
  result.force_n = start * force_n.front();
  result.g_inf = report.q[0] / start;
  for (int k = 0; k < 2; ++k) {
    const int j = k == 0 ? first : 1 - first;
    const auto at = static_cast<std::size_t>(k);
    result.g[at] = report.q[1 + j] / start;
    result.tau_s[at] = std::exp(report.q[3 + j]) * result.seconds;
    result.tau_sd_s[at] = result.tau_s[at] * std::sqrt(covariance(3 + j, 3 + j));
  }
  result.rms_relative = std::sqrt(2.0 * report.cost / problem.residuals) / start;
  result.converged = report.converged;
  return result;
}

Relaxation find_relaxation(const Measurement& m) {
  Relaxation none;
  if (m.time_s.size() != m.force_n.size()) {
    none.refused = "no time column";
    return none;
  }
  // Compression is made positive: the tool starts nearer to the free end of its travel.
  std::vector<double> x = m.depth_m;
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  if (x.front() - *low > *high - x.front()) {
    for (double& value : x) {
      value = -value;
    }
  }
  const std::vector<Segment> segments = find_segments(x);
  const auto [longest, peak] = longest_fall(segments, m.force_n);
  if (longest.end == 0) {
    none.refused = fmt::format("no hold of at least {} samples", kHoldSamplesMin);
    return none;
  }
  const std::size_t count = longest.end - peak;
  if (count < kHoldSamplesMin) {
    none.refused = "the force does not fall while held";
    return none;
  }
  // The hold from its largest force on; before, the tip still moves.
  Relaxation found = fit_relaxation(std::span(m.time_s).subspan(peak, count),
                                    std::span(m.force_n).subspan(peak, count));
  found.speed_m_per_s = press_speed_m_per_s(x, m.time_s, segments, longest.begin);
  found.joint = joint_relaxation(m, x, segments, longest);
  return found;
}

std::optional<Relaxation> find_stepwise_relaxation(const Measurement& m,
                                                   const Approach& approach) {
  const auto segments = find_segments(turned(m, approach).depth_m);
  const auto holds = std::count_if(segments.begin(), segments.end(), is_hold);
  return holds > 1 && m.time_s.size() == m.force_n.size()
             ? std::optional(find_relaxation(m))
             : std::nullopt;
}

LoopFit find_loop(const Measurement& measurement, const Approach& approach,
                  const ContactFit& fit) {
  LoopFit loop;
  loop.press_work_j = approach.press_work_j;
  loop.release_work_j = approach.release_work_j;
  if (approach.release_work_j == 0.0) {
    loop.refused = "no release";
  } else if (fit.has(FitFlag::kEmptyRun)) {
    loop.refused = "empty run";
  } else if (fit.has(FitFlag::kNonPassiveLoop)) {
    loop.refused = "the release gives more work than the press took";
  }
  if (!loop.refused.empty()) {
    return loop;
  }
  loop.loss_factor = (loop.press_work_j - loop.release_work_j) /
                     (std::numbers::pi * (loop.press_work_j + loop.release_work_j));
  if (measurement.time_s.size() != measurement.force_n.size()) {
    loop.refused = "no time column";
    return loop;
  }
  fit_hunt_crossley(motion_in_contact(turned(measurement, approach), fit), fit, loop);
  return loop;
}

}  // namespace palpate
