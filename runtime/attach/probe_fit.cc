#include "runtime/attach/probe_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

namespace palpate {
namespace {

using Samples = std::vector<ProbeSample>;

struct Shape {
  double way = 0.0;       // x / a
  double speed = 0.0;     // its slope over time
  double by_decay = 0.0;  // its slope over B
};

Shape shape_at(double s, double decay) {
  if (!(s > 0.0)) {
    return {};
  }
  const double bs = decay * s;
  if (std::abs(bs) < 1e-3) {  // the closed forms lose their digits: series
    return {.way = s * s * (0.5 - bs / 6.0 + bs * bs / 24.0),
            .speed = s * (1.0 - bs / 2.0 + bs * bs / 6.0),
            .by_decay = s * s * s * (-1.0 / 6.0 + bs / 12.0)};
  }
  const double gone = std::exp(-bs);
  const double way = (bs - 1.0 + gone) / (decay * decay);
  return {.way = way,
          .speed = (1.0 - gone) / decay,
          .by_decay = (s * (1.0 - gone) - 2.0 * decay * way) / (decay * decay)};
}

// J^T J, J^T r and r^T r of all pushes, where each push's means are taken off: x0.
struct Normal {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();  // a, B, delay
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double error = 0.0;
};

Normal normal_equations(const std::vector<Samples>& pushes, const Eigen::Vector3d& at) {
  Normal normal;
  Eigen::MatrixX4d rows;
  for (const Samples& samples : pushes) {
    rows.resize(static_cast<Eigen::Index>(samples.size()), 4);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Shape shape = shape_at(samples[i].time_s - at[2], at[1]);
      rows.row(static_cast<Eigen::Index>(i)) << shape.way, at[0] * shape.by_decay,
          -at[0] * shape.speed, samples[i].way_m - at[0] * shape.way;
    }
    rows.rowwise() -= rows.colwise().mean().eval();
    const Eigen::Matrix4d products = rows.transpose() * rows;
    normal.matrix += products.topLeftCorner<3, 3>();
    normal.right += products.topRightCorner<3, 1>();
    normal.error += products(3, 3);
  }
  return normal;
}

// The best of a grid, with its best a.
Eigen::Vector3d first_guess(const std::vector<Samples>& pushes, double push_s) {
  constexpr double kDelayStepS = 5e-4;
  Eigen::Vector3d best(1.0, 0.0, 0.0);
  double least = std::numeric_limits<double>::infinity();
  for (double delay_s = 0.0; delay_s < 0.5 * push_s; delay_s += kDelayStepS) {
    for (const double decay : {0.0, 4.0, 16.0}) {
      const Normal normal = normal_equations(pushes, {0.0, decay, delay_s});
      const double a = normal.right[0] / normal.matrix(0, 0);
      const double error = normal.error - a * normal.right[0];
      if (error < least) {
        least = error;
        best = {a, decay, delay_s};
      }
    }
  }
  return best;
}

struct Fitted {
  Eigen::Vector3d at;  // a, B, delay
  Normal normal;
};

// Levenberg and Marquardt's steps from there.
Fitted polished(const std::vector<Samples>& pushes, const Eigen::Vector3d& from,
                int steps) {
  Fitted fit{.at = from, .normal = normal_equations(pushes, from)};
  double damping = 1e-3;
  for (int i = 0; i < steps; ++i) {
    Eigen::Matrix3d matrix = fit.normal.matrix;
    matrix.diagonal() *= 1.0 + damping;
    const Eigen::Vector3d next = fit.at + matrix.ldlt().solve(fit.normal.right);
    const Normal there = normal_equations(pushes, next);
    if (there.error < fit.normal.error) {
      fit = {.at = next, .normal = there};
      damping *= 0.3;
    } else {
      damping *= 10.0;
    }
  }
  return fit;
}

// How much the pushes disagree: variances by leaving out one after the other
// (jackknife), as what a whole push has in common is no noise of its samples.
Eigen::Vector3d variance_among(const std::vector<Samples>& pushes,
                               const Eigen::Vector3d& best) {
  constexpr int kSteps = 8;
  const auto n = static_cast<double>(pushes.size());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (std::size_t out = 0; out < pushes.size(); ++out) {
    std::vector<Samples> rest = pushes;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(out));
    const Eigen::Vector3d off = polished(rest, best, kSteps).at - best;
    sum += off;
    squares += off.cwiseAbs2();
  }
  return (n - 1.0) / n * (squares - sum.cwiseAbs2() / n).cwiseMax(0.0);
}

}  // namespace

PushFit fit_pushes(const std::vector<Samples>& pushes, double push_s) {
  constexpr int kSteps = 50;
  const auto [at, normal] = polished(pushes, first_guess(pushes, push_s), kSteps);
  double samples = 0.0;
  for (const Samples& push : pushes) {
    samples += static_cast<double>(push.size());
  }
  const double freedom =
      std::max(1.0, samples - static_cast<double>(pushes.size()) - 3.0);
  Eigen::Vector3d variance =
      normal.matrix.inverse().diagonal() * (normal.error / freedom);
  if (pushes.size() > 1) {
    variance = variance.cwiseMax(variance_among(pushes, at));
  }
  const Eigen::Vector3d sd = variance.cwiseSqrt();
  return {.acceleration_m_per_s2 = at[0],
          .acceleration_sd = sd[0],
          .decay_per_s = at[1],
          .decay_sd = sd[1],
          .delay_s = at[2],
          .delay_sd = sd[2],
          .rms_m = std::sqrt(normal.error / samples)};
}

double begin_of_motion_s(const Samples& samples, double least_m) {
  double n = 0.0;
  double t = 0.0;
  double y = 0.0;
  double tt = 0.0;
  double ty = 0.0;
  for (const ProbeSample& sample : samples) {
    if (sample.way_m > least_m) {
      const double root = std::cbrt(sample.way_m);
      n += 1.0;
      t += sample.time_s;
      y += root;
      tt += sample.time_s * sample.time_s;
      ty += sample.time_s * root;
    }
  }
  const double slope = (n * ty - t * y) / (n * tt - t * t);
  return std::isfinite(slope) && slope > 0.0 ? (t - y / slope) / n
                                             : samples.back().time_s;
}

}  // namespace palpate
