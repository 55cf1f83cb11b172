#include "fitting/numerics/axial_design.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace palpate {
namespace {

constexpr double kFarther = 1.1;     // points than the sphere of the mean radius
constexpr double kNarrowest = 0.05;  // [-] of the widest
constexpr double kNoDensity = 50.0;  // stands for an infinite cost, above the centre's

class Curvature {
 public:
  Curvature(const std::function<double(const Eigen::VectorXd&)>& cost,
            const Eigen::VectorXd& centre, double step)
      : cost_(cost), centre_(centre), step_(step), at_centre_(cost(centre)) {}

  [[nodiscard]] Eigen::MatrixXd matrix() const {
    const Eigen::Index m = centre_.size();
    Eigen::MatrixXd H(m, m);
    for (Eigen::Index i = 0; i < m; ++i) {
      H(i, i) = second(step_ * Eigen::VectorXd::Unit(m, i));
    }
    for (Eigen::Index i = 0; i < m; ++i) {
      for (Eigen::Index j = i + 1; j < m; ++j) {
        const Eigen::VectorXd both =
            Eigen::VectorXd::Unit(m, i) + Eigen::VectorXd::Unit(m, j);
        H(i, j) = 0.5 * (second(step_ * both) - H(i, i) - H(j, j));
        H(j, i) = H(i, j);
      }
    }
    return H;
  }
  [[nodiscard]] double at_centre() const { return at_centre_; }

 private:
  // Second difference along d, over step^2.
  [[nodiscard]] double second(const Eigen::VectorXd& d) const {
    const auto above = [&](const Eigen::VectorXd& x) {
      const double value = cost_(x) - at_centre_;
      return std::isfinite(value) ? std::min(value, kNoDensity) : kNoDensity;
    };
    return (above(centre_ + d) + above(centre_ - d)) / (step_ * step_);
  }

  const std::function<double(const Eigen::VectorXd&)>& cost_;
  const Eigen::VectorXd& centre_;
  double step_, at_centre_;
};

}  // namespace

AxialDesign axial_design(const std::function<double(const Eigen::VectorXd&)>& cost,
                         const Eigen::VectorXd& centre, double step, double widest) {
  const Curvature curvature(cost, centre, step);
  const Eigen::Index m = centre.size();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(curvature.matrix());
  // Of a normal density, 1 / f^2 of the mass at radius f sqrt(m) gives its covariance.
  const double mass = 1.0 / (kFarther * kFarther);
  const double radius = kFarther * std::sqrt(static_cast<double>(m));
  const double normal = std::exp(0.5 * radius * radius);  // over the density there
  AxialDesign design;
  design.points.push_back({centre, 1.0 - mass});
  double log_volume = 0.5 * static_cast<double>(m) * std::log(2.0 * std::numbers::pi);
  for (Eigen::Index i = 0; i < m; ++i) {
    const double sd =
        std::clamp(1.0 / std::sqrt(std::max(axes.eigenvalues()[i], 1e-12)),
                   kNarrowest * widest, widest);
    log_volume += std::log(sd);
    for (const double side : {-1.0, 1.0}) {
      const Eigen::VectorXd x =
          centre + side * radius * sd * axes.eigenvectors().col(i);
      const double density = std::exp(curvature.at_centre() - cost(x));
      design.points.push_back(
          {x, std::isfinite(density)
                  ? mass / (2.0 * static_cast<double>(m)) * normal * density
                  : 0.0});
    }
  }
  double sum = 0.0;
  for (const WeighedPoint& point : design.points) {
    sum += point.weight;
  }
  for (WeighedPoint& point : design.points) {
    point.weight /= sum;
  }
  design.log_evidence = -curvature.at_centre() + log_volume + std::log(sum);
  return design;
}

}  // namespace palpate
