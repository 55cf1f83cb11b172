#include "fitting/lateral/lateral_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "fitting/curve/misfit.h"
#include "fitting/lateral/loop_solve.h"
#include "fitting/numerics/least_squares.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

using Vector2 = Eigen::Vector2d;
using Matrix2 = Eigen::Matrix2d;

// ln K (3), ln S, force at the start (2), offset (2) and drift (2); forces over the
// range.
enum PlaneParameter : Eigen::Index {
  kLogXx,
  kLogXy,
  kLogYy,
  kSlip,
  kPlaneStart,
  kBase = 6,
  kRise = 8,
  kPlaneParameters = 10
};
constexpr std::array kPlaneReaches{0.01, 0.03, 0.1, 0.3};  // x_p over the travel
constexpr double kFarSlip = 1e3;          // S of a spring, over the forces' range
constexpr int kSubsteps = 8;              // between samples: a sliding force turns
constexpr double kSlideLimit = 0.98;      // [-] of S, at which a sample slides
constexpr double kDerivativeStep = 1e-6;  // [-]
constexpr double kTensorVariance = 1.0;   // of ln K: more is no value

Matrix2 stiffness_of(const Eigen::VectorXd& q) {
  Matrix2 log;
  log << q[kLogXx], q[kLogXy], q[kLogXy], q[kLogYy];
  const Eigen::SelfAdjointEigenSolver<Matrix2> axes(log);
  return axes.eigenvectors() * axes.eigenvalues().array().exp().matrix().asDiagonal() *
         axes.eigenvectors().transpose();
}

// Samples in the plane: places of the contact and forces.
struct PlanePath {
  LateralPath along;
  std::vector<Vector2> place_m, force_n;
  double range_n = 0.0;
};

PlanePath plane_path(const LateralRun& run, const FrameCompliance* frame) {
  LateralRun first = run;
  PlanePath path{find_lateral_path(first), {}, {}, 0.0};
  const std::size_t n = path.along.force_n.size();
  if (run.across_m.size() != run.force_n.size() ||
      run.across_n.size() != run.force_n.size()) {
    throw InputError(fmt::format("{} forces, but {} displacements and {} forces across",
                                 run.force_n.size(), run.across_m.size(),
                                 run.across_n.size()));
  }
  const double sign = path.along.force_turned ? -1.0 : 1.0;
  const double give = frame == nullptr ? 0.0 : 1.0 / frame->stiffness_n_per_m;  // [m/N]
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t at = path.along.first + i;
    const Vector2 force = sign * Vector2(run.force_n[at], run.across_n[at]);
    path.force_n.push_back(force);
    path.place_m.push_back(Vector2(run.displacement_m[at], run.across_m[at]) -
                           give * force);
  }
  Vector2 low = path.force_n.front(), high = low;
  for (const Vector2& force : path.force_n) {
    low = low.cwiseMin(force);
    high = high.cwiseMax(force);
  }
  path.range_n = (high - low).maxCoeff();
  return path;
}

// Forces of the friction alone at all samples [N].
std::vector<Vector2> friction_along(const PlanePath& path, ContactLaw law,
                                    const Eigen::VectorXd& q) {
  const int count = law == ContactLaw::kSharpSlip ? 1 : kPlaneElements;
  const Matrix2 K = stiffness_of(q);
  const double slip = std::exp(q[kSlip]);
  std::vector<Vector2> bears(static_cast<std::size_t>(count),  // K s_e
                             path.range_n * q.segment<2>(kPlaneStart));
  std::vector<Vector2> forces;
  for (std::size_t i = 0; i < path.place_m.size(); ++i) {
    const Vector2 way = i == 0 ? Vector2::Zero().eval()
                               : Vector2(path.place_m[i] - path.place_m[i - 1]);
    const Vector2 more = K * way / kSubsteps;
    Vector2 sum = Vector2::Zero();
    for (int e = 0; e < count; ++e) {
      const double y = (e + 0.5) / count;
      const double rho = count == 1 ? 1.0 : 1.5 * (1.0 - y * y);
      const double limit = rho * slip * path.along.normal_share[i];
      Vector2& force = bears[static_cast<std::size_t>(e)];
      for (int step = 0; step < kSubsteps; ++step) {
        force += more;
        const double size = force.norm();
        force *= size > limit ? limit / size : 1.0;
      }
      sum += force / count;
    }
    forces.push_back(sum);
  }
  return forces;
}

void plane_residual(const PlanePath& path, ContactLaw law, const Eigen::VectorXd& q,
                    Eigen::Ref<Eigen::VectorXd> r) {
  const auto friction = friction_along(path, law, q);
  const auto n = static_cast<Eigen::Index>(path.along.fitted.size());
  for (Eigen::Index row = 0; row < n; ++row) {
    const std::size_t i = path.along.fitted[static_cast<std::size_t>(row)];
    const Vector2 misses = (friction[i] - path.force_n[i]) / path.range_n +
                           q.segment<2>(kBase) +
                           path.along.clock[i] * q.segment<2>(kRise);
    r[row] = misses[0];
    r[n + row] = misses[1];
  }
}

// Derivatives by central differences.
LeastSquaresProblem plane_problem(const PlanePath& path, ContactLaw law,
                                  const std::vector<bool>& held) {
  LeastSquaresProblem problem;
  problem.residuals = static_cast<int>(2 * path.along.fitted.size());
  problem.in_a_row = problem.residuals;
  problem.held = held;
  problem.evaluate = [&path, law, held](const Eigen::VectorXd& q,
                                        const Eigen::Ref<Eigen::VectorXd>& r,
                                        RowMajorMatrix* jacobian) {
    plane_residual(path, law, q, r);
    Eigen::VectorXd above(r.size()), below(r.size());
    for (Eigen::Index j = 0; jacobian != nullptr && j < q.size(); ++j) {
      jacobian->col(j).setZero();
      if (!held[static_cast<std::size_t>(j)]) {
        Eigen::VectorXd up = q, down = q;
        up[j] += kDerivativeStep;
        down[j] -= kDerivativeStep;
        plane_residual(path, law, up, above);
        plane_residual(path, law, down, below);
        jacobian->col(j) = (above - below) / (2.0 * kDerivativeStep);
      }
    }
    return true;
  };
  return problem;
}

std::vector<Eigen::VectorXd> plane_starts(const PlanePath& path) {
  Vector2 low = path.force_n.front(), high = low;
  for (const Vector2& force : path.force_n) {
    low = low.cwiseMin(force);
    high = high.cwiseMax(force);
  }
  const Vector2 middle = 0.5 * (low + high);
  std::vector<Eigen::VectorXd> starts;
  for (const double reach : kPlaneReaches) {
    Eigen::VectorXd q = Eigen::VectorXd::Zero(kPlaneParameters);
    q[kSlip] = std::log(0.5 * path.range_n);
    q[kLogXx] = q[kLogYy] = q[kSlip] - std::log(reach * path.along.travel_m);
    q.segment<2>(kBase) = middle / path.range_n;
    q.segment<2>(kPlaneStart) = (path.force_n.front() - middle) / path.range_n;
    starts.push_back(q);
  }
  return starts;
}

struct SolvedPlane {
  ContactLaw law = ContactLaw::kSharpSlip;
  Eigen::VectorXd q, residual;
  Eigen::MatrixXd covariance;
  std::size_t slides = 0;  // samples
  double borne_n = 0.0;    // largest force of the contact
};

// @param slides else a spring whose slip is far away
SolvedPlane solve_plane(const PlanePath& path, ContactLaw law, bool slides = true) {
  SolvedPlane solved;
  solved.law = law;
  std::vector<bool> held(kPlaneParameters, false);
  std::vector<Eigen::VectorXd> starts = plane_starts(path);
  if (!slides) {
    // The force at the start and the offset are then one.
    held[kSlip] = held[kPlaneStart] = held[kPlaneStart + 1] = true;
    for (Eigen::VectorXd& q : starts) {
      q[kSlip] = std::log(kFarSlip * path.range_n);
      q.segment<2>(kBase) += q.segment<2>(kPlaneStart);
      q.segment<2>(kPlaneStart).setZero();
    }
  }
  held[kRise] = held[kRise + 1] = path.along.turn.size() < 2;
  const LeastSquaresProblem problem = plane_problem(path, law, held);
  solved.q = solve_from_starts(problem, starts, {.tolerance = 1e-10}).q;
  solved.residual.resize(problem.residuals);
  plane_residual(path, law, solved.q, solved.residual);
  solved.covariance = least_squares_covariance(problem, solved.q);
  const auto friction = friction_along(path, law, solved.q);
  for (const std::size_t i : path.along.fitted) {
    const double share =
        friction[i].norm() / std::exp(solved.q[kSlip]) / path.along.normal_share[i];
    solved.slides += share >= kSlideLimit ? 1 : 0;
    solved.borne_n = std::max(solved.borne_n, share * std::exp(solved.q[kSlip]));
  }
  return solved;
}

void state_stiffness(const SolvedPlane& solved, PlaneFit& fit) {
  const auto entry = [&](int i, int j) {
    return estimate(
        [i, j](const Eigen::VectorXd& q) {
          return stiffness_of(q)(i, j);
        },
        solved.q, solved.covariance);
  };
  const bool told = solved.covariance.allFinite() &&
                    solved.covariance.diagonal().head<3>().maxCoeff() < kTensorVariance;
  const IntervalEstimate none =
      refused_estimate("the contact does not stick in both directions");
  fit.xx_n_per_m = told ? entry(0, 0) : none;
  fit.xy_n_per_m = told ? entry(0, 1) : none;
  fit.yy_n_per_m = told ? entry(1, 1) : none;
}

void state_slip(const SolvedPlane& solved, PlaneFit& fit) {
  const bool has_normal = !std::isnan(fit.normal_n);
  if (solved.slides < kLoopPartMin) {
    const std::string never = "the contact never slides";
    fit.slip_force_n = refused_estimate(never, solved.borne_n);
    fit.friction = refused_estimate(never, solved.borne_n / fit.normal_n);
    fit.presliding_m = refused_estimate(never);
    return;
  }
  const auto by_slip = [&](auto&& log_of) {
    return estimate_of_log(log_of, solved.q, solved.covariance);
  };
  fit.slip_force_n = by_slip([](const Eigen::VectorXd& q) {
    return q[kSlip];
  });
  fit.friction = has_normal ? by_slip([&](const Eigen::VectorXd& q) {
    return q[kSlip] - std::log(fit.normal_n);
  })
                            : refused_estimate(
                                  "no normal force is given: "
                                  "--normal-force-column or "
                                  "--normal-force-n");
  fit.presliding_m = fit.xx_n_per_m.refused.empty()
                         ? by_slip([](const Eigen::VectorXd& q) {
                             return q[kSlip] - std::log(0.5 * stiffness_of(q).trace());
                           })
                         : refused_estimate("needs the tangential stiffness");
}

std::span<const double> plane_span(const Eigen::VectorXd& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

// -2 log of how much less likely the second is, by the noise of the first.
double plane_deviance(const SolvedPlane& by, const SolvedPlane& other) {
  if (!(by.residual.squaredNorm() > 0.0)) {
    return other.residual.squaredNorm() > 0.0 ? std::numeric_limits<double>::max()
                                              : 0.0;
  }
  std::vector<double> order(static_cast<std::size_t>(by.residual.size()));
  std::iota(order.begin(), order.end(), 0.0);
  return ResidualNoise(order, plane_span(by.residual))
      .deviance(plane_span(other.residual));
}

}  // namespace

LineMotion along_line(const LateralRun& run) {
  LineMotion line{run, false, 0.0};
  if (run.across_m.size() != run.displacement_m.size() ||
      run.across_n.size() != run.force_n.size() || run.across_m.empty()) {
    return line;
  }
  const auto n = static_cast<Eigen::Index>(run.across_m.size());
  Eigen::MatrixXd places(n, 2), forces(n, 2);
  places << Eigen::Map<const Eigen::VectorXd>(run.displacement_m.data(), n),
      Eigen::Map<const Eigen::VectorXd>(run.across_m.data(), n);
  forces << Eigen::Map<const Eigen::VectorXd>(run.force_n.data(), n),
      Eigen::Map<const Eigen::VectorXd>(run.across_n.data(), n);
  const Eigen::MatrixXd centred = places.rowwise() - places.colwise().mean();
  const Eigen::SelfAdjointEigenSolver<Matrix2> axes(
      Matrix2(centred.transpose() * centred));
  const double width = std::sqrt(std::max(0.0, axes.eigenvalues()[0]));
  line.on_line = !(width > kLineShare * std::sqrt(axes.eigenvalues()[1]));
  if (!line.on_line) {
    return line;
  }
  Vector2 direction = axes.eigenvectors().col(1);
  direction *= direction[direction[0] == 0.0 ? 1 : 0] < 0.0 ? -1.0 : 1.0;
  line.direction_rad = std::atan2(direction[1], direction[0]);
  const Eigen::VectorXd along = places * direction, force = forces * direction;
  line.run.displacement_m.assign(along.begin(), along.end());
  line.run.force_n.assign(force.begin(), force.end());
  line.run.across_m.clear();
  line.run.across_n.clear();
  return line;
}

PlaneFit fit_plane(const LateralRun& run, const FrameCompliance* frame) {
  const PlanePath path = plane_path(run, frame);
  SolvedPlane better = solve_plane(path, ContactLaw::kSharpSlip),
              other = solve_plane(path, ContactLaw::kPartialSlip);
  if (other.residual.squaredNorm() < better.residual.squaredNorm()) {
    std::swap(better, other);
  }
  PlaneFit fit;
  fit.name = run.name;
  fit.law = better.law;
  fit.depth_m = run.depth_m;
  fit.normal_n = path.along.normal_n;
  const auto count = static_cast<double>(path.along.fitted.size());
  fit.rms_n = path.range_n * better.residual.norm() / std::sqrt(2.0 * count);
  fit.other_rms_n = path.range_n * other.residual.norm() / std::sqrt(2.0 * count);
  fit.deviance = plane_deviance(better, other);
  SolvedPlane spring = solve_plane(path, ContactLaw::kSharpSlip, false);
  if (plane_deviance(better, spring) < kSlipDeviance) {
    spring.slides = 0;
    better = spring;  // noise alone slides
  }
  state_stiffness(better, fit);
  state_slip(better, fit);
  return fit;
}

}  // namespace palpate
