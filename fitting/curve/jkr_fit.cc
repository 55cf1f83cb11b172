#include "fitting/curve/jkr_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "fitting/numerics/least_squares.h"

namespace palpate {
namespace {

constexpr std::size_t kContactMin = 12;     // samples
constexpr double kJkrDepthShareMax = 0.25;  // [-] of the radius
using std::numbers::pi;

// Terms of the law at contact radius a: pushing and pulling parts of force and depth.
struct Jkr {
  double R, E, W;

  [[nodiscard]] double force_push(double a) const {
    return 4.0 * E * a * a * a / (3.0 * R);
  }
  [[nodiscard]] double force_pull(double a) const {
    return std::sqrt(8.0 * pi * W * E * a * a * a);
  }
  [[nodiscard]] double depth_pull(double a) const {
    return std::sqrt(2.0 * pi * W * a / E);
  }
  [[nodiscard]] double force(double a) const { return force_push(a) - force_pull(a); }
  [[nodiscard]] double depth(double a) const { return a * a / R - depth_pull(a); }
  [[nodiscard]] double force_by_a(double a) const {
    return (3.0 * force_push(a) - 1.5 * force_pull(a)) / a;
  }
  [[nodiscard]] double depth_by_a(double a) const {
    return (2.0 * a * a / R - 0.5 * depth_pull(a)) / a;
  }

  // dd/da = 0: less contact is not stable while the depth is held.
  [[nodiscard]] double least_a() const { return std::cbrt(pi * W * R * R / (8.0 * E)); }

  // Newton from above converges without a step back: d(a) is convex.
  [[nodiscard]] double contact_radius(double d) const {
    const double least = least_a();
    if (d <= depth(least)) {
      return least;
    }
    // d(a) >= a^2 / (4 R) where a^1.5 >= (4/3) sqrt(2 pi W R^2 / E), so that the larger
    // of both has at least this depth.
    double a = std::max(std::cbrt(16.0 / 9.0 * 2.0 * pi * W * R * R / E),
                        2.0 * std::sqrt(R * std::max(d, 0.0)));
    for (int i = 0; i < 60; ++i) {
      const double step = (depth(a) - d) / depth_by_a(a);
      a -= step;
      if (!(std::abs(step) > 1e-14 * a)) {
        break;
      }
    }
    return std::max(a, least);
  }
};

// Samples from the jump into contact on, forces over the baseline.
struct SinceJump {
  std::vector<double> x, f;
};

SinceJump since_jump(const Approach& approach, const Adhesion& adhesion) {
  SinceJump contact;
  std::vector<double> f;
  for (std::size_t i = 0; i < approach.force_n.size(); ++i) {
    f.push_back(approach.force_n[i] - adhesion.zero_n -
                adhesion.slope_n_per_m * approach.displacement_m[i]);
  }
  const auto dip = std::min_element(f.begin(), f.end()) - f.begin();
  contact.x.assign(approach.displacement_m.begin() + dip,
                   approach.displacement_m.end());
  contact.f.assign(f.begin() + dip, f.end());
  return contact;
}

// q: contact point from the first sample over the travel, ln of E and W over their
// starts.
LeastSquaresProblem problem_of(const SinceJump& c, const Jkr& start) {
  LeastSquaresProblem problem;
  problem.residuals = problem.in_a_row = static_cast<int>(c.x.size());
  problem.lower = Eigen::Vector3d(-1.0, -7.0, -7.0);
  problem.upper = Eigen::Vector3d(0.5, 7.0, 7.0);
  const double length = c.x.back() - c.x.front();
  const double size = *std::max_element(c.f.begin(), c.f.end());
  // F = 4 E a^3 / (3 R) - sqrt(8 pi W E a^3), d = a^2 / R - sqrt(2 pi W a / E), E
  // reduced (Johnson, Kendall, Roberts 1971). a follows from d; slope = dF/dd = (dF/da)
  // / (dd/da).
  problem.evaluate = [&c, start, length, size](const Eigen::VectorXd& q,
                                               Eigen::Ref<Eigen::VectorXd> r,
                                               RowMajorMatrix* jacobian) {
    const Jkr law{start.R, start.E * std::exp(q[1]), start.W * std::exp(q[2])};
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double a = law.contact_radius(c.x[k] - c.x.front() - length * q[0]);
      r[i] = (law.force(a) - c.f[k]) / size;
      if (jacobian != nullptr) {
        const bool least = !(a > law.least_a() * (1.0 + 1e-9));
        if (least) {
          // Held at the least radius: F = -5/6 pi W R, whatever the depth.
          jacobian->row(i) << 0.0, 0.0, law.force(a);
        } else {
          const double slope = law.force_by_a(a) / law.depth_by_a(a);
          // By ln E and ln W at fixed d: dF/dq - slope dd/dq, both at fixed a. Pulls
          // go with sqrt(W E) in force, and with sqrt(W / E) in depth.
          jacobian->row(i) << -slope * length,
              law.force_push(a) - 0.5 * law.force_pull(a) -
                  slope * 0.5 * law.depth_pull(a),
              -0.5 * law.force_pull(a) + slope * 0.5 * law.depth_pull(a);
        }
        jacobian->row(i) /= size;
      }
    }
    return true;
  };
  return problem;
}

JkrFit refused_jkr(std::string why) {
  JkrFit fit;
  fit.refused = std::move(why);
  return fit;
}

JkrFit solve_jkr(const SinceJump& c, const Jkr& start) {
  const LeastSquaresProblem problem = problem_of(c, start);
  const auto report = solve_from_starts(
      problem, {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(-0.05, 0.5, 0.0),
                Eigen::Vector3d(0.05, 0.0, -0.5)});
  const Eigen::Vector3d sd =
      least_squares_covariance(problem, report.q).diagonal().cwiseSqrt();
  if (!report.converged) {
    return refused_jkr("the fit did not converge");
  }
  const double length = c.x.back() - c.x.front();
  const double size = *std::max_element(c.f.begin(), c.f.end());
  JkrFit fit;
  fit.contact_point_m = c.x.front() + length * report.q[0];
  fit.contact_point_sd_m = length * sd[0];
  fit.reduced_modulus_pa = start.E * std::exp(report.q[1]);
  fit.reduced_modulus_sd_pa = fit.reduced_modulus_pa * sd[1];
  fit.work_j_per_m2 = start.W * std::exp(report.q[2]);
  fit.work_sd_j_per_m2 = fit.work_j_per_m2 * sd[2];
  fit.rms_n = size * std::sqrt(2.0 * report.cost / problem.residuals);
  return fit;
}

// Why a fit is not reported; empty where it is.
std::string why_not(const JkrFit& fit, const Approach& approach,
                    const Adhesion& adhesion, double radius_m) {
  const double ratio = fit.pull_off_work_j_per_m2 / fit.work_j_per_m2;
  if (!(std::abs(std::log(ratio)) < std::log(kAdhesionHysteresisMax))) {
    return fmt::format(
        "the work of adhesion is {:.3g} J/m^2 on the approach and {:.3g} J/m^2 at the "
        "pull-off: not in equilibrium",
        fit.work_j_per_m2, fit.pull_off_work_j_per_m2);
  }
  const double depth = *std::max_element(approach.displacement_m.begin(),
                                         approach.displacement_m.end()) -
                       fit.contact_point_m;
  if (depth > kJkrDepthShareMax * radius_m) {
    return fmt::format("{:.3g} m deep: more than a quarter of the radius", depth);
  }
  if (fit.rms_n > kJkrMisfit * adhesion.noise_n) {
    return fmt::format(
        "residuals of {:.3g} N rms, noise {:.3g} N: the law does not fit", fit.rms_n,
        adhesion.noise_n);
  }
  return "";
}

}  // namespace

double jkr_force_n(double depth_m, double radius_m, double reduced_modulus_pa,
                   double work_j_per_m2) {
  const Jkr law{radius_m, reduced_modulus_pa, work_j_per_m2};
  return law.force(law.contact_radius(depth_m));
}

JkrFit fit_jkr(const Approach& approach, const Adhesion& adhesion, double radius_m) {
  if (!adhesion.pulls_off || !adhesion.snaps_in) {
    return refused_jkr(adhesion.pulls_off ? "no jump into contact is seen"
                                          : "no pull-off is seen");
  }
  const SinceJump contact = since_jump(approach, adhesion);
  if (contact.x.size() < kContactMin) {
    return refused_jkr(fmt::format("{} samples after the jump into contact, need {}",
                                   contact.x.size(), kContactMin));
  }
  const double depth = contact.x.back() - contact.x.front();
  const double force = *std::max_element(contact.f.begin(), contact.f.end());
  if (!(depth > 0.0) || !(force > 0.0)) {
    return refused_jkr("the force never pushes");
  }
  // Start: Hertz's law at the largest force, and W of the pull-off.
  const Jkr start{radius_m, 0.75 * force / (std::sqrt(radius_m) * std::pow(depth, 1.5)),
                  jkr_work_of_adhesion(adhesion.pull_off_n, radius_m)};
  JkrFit fit = solve_jkr(contact, start);
  fit.pull_off_work_j_per_m2 = start.W;
  if (fit.refused.empty()) {
    fit.refused = why_not(fit, approach, adhesion, radius_m);
  }
  return fit;
}

}  // namespace palpate
