#include "fitting/material/layer_fit.h"

#include <algorithm>
#include <cmath>

#include "fitting/material/moduli.h"
#include "fitting/numerics/least_squares.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kContactShare = 0.4;  // [-] of the depth: how far contact may move
constexpr double kStep = 1e-6;         // [-] of the depth, for derivatives

enum LayerParameter { kForce, kSlope, kStart, kModulus, kLayerParameters };

// The force on the sphere over E [m^2].
double force_per_modulus(const Indenter& sphere, double depth_m) {
  if (!(depth_m > 0.0)) {
    return 0.0;
  }
  // 4/3 sqrt(R) d^1.5 / (1 - nu^2) times the layer's factor at chi = sqrt(R d) / h.
  const double nu = sphere.poissons_ratio, R = sphere.radius_m;
  const double chi = std::sqrt(R * depth_m) / sphere.thickness_m;
  return 4.0 / 3.0 / (1.0 - nu * nu) * std::sqrt(R) * std::pow(depth_m, 1.5) *
         sphere_layer_factor(chi, nu);
}

// Displacement from the power law's contact point over its depth; forces over the
// largest; E over `modulus_pa`.
struct LayerCurve {
  const Indenter& sphere;
  Eigen::VectorXd x, f;
  double length_m, force_n, modulus_pa;

  [[nodiscard]] double force(double depth) const {
    return modulus_pa * force_per_modulus(sphere, depth * length_m) / force_n;
  }
};

bool layer_residuals(const LayerCurve& curve, const Eigen::VectorXd& q,
                     Eigen::Ref<Eigen::VectorXd> r, RowMajorMatrix* jacobian) {
  try {
    for (Eigen::Index i = 0; i < curve.x.size(); ++i) {
      const double d = curve.x[i] - q[kStart], g = curve.force(d);
      r[i] = q[kForce] + q[kSlope] * curve.x[i] + q[kModulus] * g - curve.f[i];
      if (jacobian != nullptr) {
        const double rise = curve.force(d + kStep) - curve.force(d - kStep);
        jacobian->row(i) << 1.0, curve.x[i], -q[kModulus] * rise / (2.0 * kStep), g;
      }
    }
  } catch (const InputError&) {
    return false;  // deeper than the layer's factor is known
  }
  return true;
}

LayerCurve scaled(const Approach& approach, const ContactFit& start,
                  const Indenter& indenter) {
  const auto n = std::ssize(approach.force_n);
  const Eigen::Map<const Eigen::VectorXd> x(approach.displacement_m.data(), n);
  const Eigen::Map<const Eigen::VectorXd> f(approach.force_n.data(), n);
  LayerCurve curve{indenter,
                   (x.array() - start.contact_point_m) / start.depth_max_m,
                   f,
                   start.depth_max_m,
                   contact_force_n(start, start.depth_max_m),
                   1.0};
  curve.f /= curve.force_n;
  curve.modulus_pa = 1.0 / curve.force(1.0);
  return curve;
}

}  // namespace

LayerFit fit_sphere_on_layer(const Approach& approach, const ContactFit& start,
                             const Indenter& indenter) {
  const LayerCurve curve = scaled(approach, start, indenter);
  // r_i = b0 + b1 x_i + E f(x_i - start) - f_i. x is counted from the power law's
  // contact point in depths, E over the modulus that gives the largest force at depth
  // 1.
  LeastSquaresProblem problem;
  problem.residuals = problem.in_a_row = static_cast<int>(curve.x.size());
  problem.evaluate = [&curve](const Eigen::VectorXd& q,
                              const Eigen::Ref<Eigen::VectorXd>& r,
                              RowMajorMatrix* jacobian) {
    return layer_residuals(curve, q, r, jacobian);
  };
  problem.lower = Eigen::Vector4d(-kInf, -kInf, -kContactShare, 0.0);
  problem.upper = Eigen::Vector4d(kInf, kInf, kContactShare, kInf);
  // Contact is not looked for where the tool is known to be free.
  const double given =
      (approach.contact_from_m - start.contact_point_m) / curve.length_m;
  problem.lower[kStart] = std::clamp(given, -kContactShare, 0.0);
  problem.held = {false, !start.parameters[kSlope].held.empty(), false, false};
  const double b0 = start.parameters[kForce].value, b1 = start.parameters[kSlope].value;
  const Eigen::Vector4d q0((b0 + b1 * start.contact_point_m) / curve.force_n,
                           b1 * curve.length_m / curve.force_n, 0.0, 1.0);
  const LeastSquaresReport report = solve_least_squares(problem, q0);
  if (!report.converged) {
    throw NumericalError("the layer's law did not converge");
  }
  const Eigen::VectorXd sd =
      least_squares_covariance(problem, report.q).diagonal().cwiseSqrt();
  return {curve.modulus_pa * report.q[kModulus], curve.modulus_pa * sd[kModulus],
          start.contact_point_m + curve.length_m * report.q[kStart],
          curve.length_m * sd[kStart]};
}

}  // namespace palpate
