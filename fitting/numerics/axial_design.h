// What a density exp(-cost) weighs around its maximum, by few points: integrals over
// uncertain parameters (after Rue, Martino and Chopin 2009, 6.5).
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace palpate {

struct WeighedPoint {
  Eigen::VectorXd x;    ///< (m)
  double weight = 0.0;  ///< [-] sum 1
};

struct AxialDesign {
  std::vector<WeighedPoint> points;  ///< 2 m + 1, the centre first
  double log_evidence = 0.0;         ///< log of the integral of exp(-cost)
};

/// The centre, and two points along each principal axis of the cost's curvature there,
/// at 1.1 sqrt(m) standard deviations. Points are weighed by exp(-cost) so that for a
/// normal density mean and covariance are exact. Curvature by differences of `step`; no
/// axis is taken to be wider than `widest`.
/// @param cost of m variables, not finite where there is no density. @param centre its
/// minimum, or near it.
[[nodiscard]] AxialDesign axial_design(
    const std::function<double(const Eigen::VectorXd&)>& cost,
    const Eigen::VectorXd& centre, double step, double widest);

}  // namespace palpate
