// Minimum of a function of a few variables, without derivatives.
#pragma once

#include <functional>

#include <Eigen/Core>

namespace palpate {

struct SimplexOptions {
  double step = 0.5;          ///< of the first simplex, in every variable
  double tolerance_x = 1e-3;  ///< stops when the simplex is smaller, and ...
  double tolerance_f = 1e-6;  ///< ... its values differ by less
  int evaluations = 400;      ///< at most
};

struct SimplexReport {
  Eigen::VectorXd x;  ///< the best point seen
  double value = 0.0;
  int evaluations = 0;
  bool converged = false;
};

/// Downhill simplex (Nelder and Mead 1965). Infinite or NaN values count as walls.
/// @param f of n variables, finite at `start`.
[[nodiscard]] SimplexReport minimise_simplex(
    const std::function<double(const Eigen::VectorXd&)>& f,
    const Eigen::VectorXd& start, const SimplexOptions& options = {});

}  // namespace palpate
