#pragma once
#include <variant>

#include <Eigen/Core>
namespace palpate {
using Tangent = Eigen::Matrix<double, 9, 9>;
enum class VolumeMeasure { kNone, kSmallTrace, kGreenTrace, kJacobian };
struct LocalResponse {
  double energy_density = 0;
  Eigen::Matrix3d stress;
  Tangent tangent;
};
struct VolumeResponse {
  double theta;
  Eigen::Matrix3d gradient;
  Tangent curvature;
};
struct Linear {
  double mu = 0, lambda = 0;
};
struct NeoHookean {
  double mu = 0, k = 0;
};
using Material = std::variant<Linear, NeoHookean>;
double distortion_energy(const Material&, const Eigen::Matrix3d& F);
LocalResponse distortion_response(const Material&, const Eigen::Matrix3d& F);
VolumeMeasure volume_measure(const Material&);
double volume_modulus_pa(const Material&);
double volume_theta(VolumeMeasure, const Eigen::Matrix3d& F);
VolumeResponse volume_response(VolumeMeasure, const Eigen::Matrix3d& F);
bool is_linear(const Material&);
Linear linear(double E, double nu);
NeoHookean neo_hookean(double E, double nu);
}  // namespace palpate
