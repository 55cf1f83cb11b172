// The least-squares problem behind a material fit, in scaled parameters.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "fitting/material/sweep_interpolation.h"

namespace palpate {

/// A curve's samples in its own units, against one vertex of the sweep.
struct ScaledMaterialCurve {
  SweepInterpolation law;
  std::vector<double> x = {};  ///< (n) [-] displacement over length_m, first smallest
  std::vector<double> f = {};  ///< (n) [-] force over force_n
  double length_m = 1.0;
  double force_n = 1.0;
  double sigma = 1.0;  ///< [-] residuals count in these units
};

struct MaterialState {
  Eigen::VectorXd log_parameter;                  ///< (p)
  std::vector<Eigen::Vector2d> contact_baseline;  ///< per curve [-], in its units
  double log_factor = 0.0;                        ///< [-] on all the sweep's forces
};

struct MaterialSolve {
  MaterialState state;
  double squares = 0.0;  ///< [-] sum of residuals squared, in units of sigma
  bool converged = false;
  int iterations = 0;
};

struct MaterialBox {
  Eigen::VectorXd lower, upper;  ///< (p) logarithms
};

/// Minimises from `start`; @param held a parameter that keeps its value.
/// @param factor_sd of log_factor, expected to be 0: its square over that is one more
/// residual; 0: there is no factor.
[[nodiscard]] MaterialSolve solve_material(
    const std::vector<ScaledMaterialCurve>& curves, const MaterialState& start,
    const MaterialBox& box, double factor_sd, std::optional<int> held = std::nullopt);

/// Residuals of one curve [-], in its units of force.
[[nodiscard]] std::vector<double> material_residuals(const ScaledMaterialCurve& curve,
                                                     const MaterialState& state,
                                                     std::size_t place);

/// Covariance of the parameters' logarithms (p x p), contact points, baselines and the
/// factor free. Directions that the data say nothing of get a variance of 1e12 of what
/// a lone parameter would have. So correlations state what goes together.
[[nodiscard]] Eigen::MatrixXd material_covariance(
    const std::vector<ScaledMaterialCurve>& curves, const MaterialState& state,
    double factor_sd);

}  // namespace palpate
