#include "fitting/curve/time_drift.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "fitting/numerics/correlated_noise.h"

namespace palpate {
namespace {

constexpr double kTooUncertain = 0.1;  // [-] of the force's range, over the whole time

// Columns 1, x, t scaled to about 1, and with `leap` one that is 1 after the retract.
Eigen::MatrixXd design(const Measurement& m, const FreeSamples& free, double seconds,
                       bool leap) {
  const auto before = static_cast<Eigen::Index>(free.before.size());
  const auto n = before + static_cast<Eigen::Index>(free.after.size());
  const auto [low, high] = std::minmax_element(m.depth_m.begin(), m.depth_m.end());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, leap ? 4 : 3);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::size_t i = k < before ? free.before[static_cast<std::size_t>(k)]
                                     : free.after[static_cast<std::size_t>(k - before)];
    J.row(k).head<3>() << 1.0, (m.depth_m[i] - *low) / (*high - *low),
        (m.time_s[i] - m.time_s.front()) / seconds;
    if (leap && k >= before) {
      J(k, 3) = 1.0;
    }
  }
  return J;
}

Eigen::VectorXd forces(const Measurement& m, const FreeSamples& free) {
  Eigen::VectorXd f(static_cast<Eigen::Index>(free.before.size() + free.after.size()));
  Eigen::Index k = 0;
  for (const auto* samples : {&free.before, &free.after}) {
    for (const std::size_t i : *samples) {
      f[k++] = m.force_n[i];
    }
  }
  return f;
}

struct DriftLine {
  Eigen::VectorXd q, sd;  // sd NaN where the columns depend on each other
};

DriftLine fit_line(const Eigen::MatrixXd& J, const Eigen::VectorXd& f) {
  DriftLine line;
  line.q = J.completeOrthogonalDecomposition().solve(f);
  const Eigen::MatrixXd covariance =
      covariance_under_noise(J, f - J * line.q, J.rows());
  line.sd = covariance.diagonal().cwiseSqrt();
  return line;
}

double range(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

}  // namespace

TimeDrift find_time_drift(const Measurement& measurement, const Approach& approach,
                          const ContactFit& fit) {
  TimeDrift drift;
  if (measurement.time_s.size() != measurement.force_n.size() ||
      measurement.time_s.empty()) {
    drift.refused = "no time column";
    return drift;
  }
  drift.seconds = measurement.time_s.back() - measurement.time_s.front();
  const Measurement m = turned(measurement, approach);
  const FreeSamples free = free_samples(m, approach, fit);
  drift.samples = free.before.size() + free.after.size();
  if (!(drift.seconds > 0.0) || drift.samples < kFreeMin || free.before.empty()) {
    drift.refused =
        fmt::format("{} free samples before contact and {} after the retract, need {}",
                    free.before.size(), free.after.size(), kFreeMin);
    return drift;
  }
  const Eigen::VectorXd f = forces(m, free);
  // Free force = q0 + q1 x + q2 t, x and t scaled to 0 to 1 [N].
  const DriftLine steady = fit_line(design(m, free, drift.seconds, false), f);
  if (!(steady.sd[2] < kTooUncertain * range(m.force_n))) {
    drift.refused =
        "a drift with time cannot be distinguished from one with displacement";
    return drift;
  }
  if (!free.after.empty()) {
    // A fourth column is 1 after the retract: a step there is no steady drift.
    const DriftLine leap = fit_line(design(m, free, drift.seconds, true), f);
    if (std::abs(leap.q[3]) > kDriftDeviations * leap.sd[3]) {
      drift.leaps = true;
      drift.refused = fmt::format(
          "the baseline leaps by {:.3g} N between approach and retract: no steady "
          "drift",
          leap.q[3]);
      return drift;
    }
  }
  drift.n_per_s = steady.q[2] / drift.seconds;
  drift.sd_n_per_s = steady.sd[2] / drift.seconds;
  drift.significant = std::abs(steady.q[2]) > kDriftDeviations * steady.sd[2];
  return drift;
}

void take_off_drift(const TimeDrift& drift, const Approach& approach,
                    Measurement& measurement) {
  if (!drift.refused.empty() || !drift.significant) {
    return;
  }
  const bool turned_sign = std::find(approach.flags.begin(), approach.flags.end(),
                                     FitFlag::kForceSignTurned) != approach.flags.end();
  const double c = turned_sign ? -drift.n_per_s : drift.n_per_s;
  for (std::size_t i = 0; i < measurement.force_n.size(); ++i) {
    measurement.force_n[i] -= c * (measurement.time_s[i] - measurement.time_s.front());
  }
}

}  // namespace palpate
