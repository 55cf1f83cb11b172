#include "precompute/material/material_linear.h"

#include <algorithm>

#include "precompute/material/material_check.h"
#include "precompute/material/strain_invariants.h"

namespace palpate {
namespace {

Eigen::Matrix3d small_strain(const Eigen::Matrix3d& F) {
  return 0.5 * (F + F.transpose()) - Eigen::Matrix3d::Identity();
}

// The part of lambda that the distortion keeps.
double negative_part(double lambda) {
  return std::min(lambda, 0.0);
}

}  // namespace

Linear linear(double youngs_modulus_pa, double poissons_ratio) {
  const double mu = shear_modulus_from(youngs_modulus_pa, poissons_ratio);
  return {mu, lame_lambda_from(mu, poissons_ratio)};
}

StVenantKirchhoff st_venant_kirchhoff(double youngs_modulus_pa, double poissons_ratio) {
  const double mu = shear_modulus_from(youngs_modulus_pa, poissons_ratio);
  return {mu, lame_lambda_from(mu, poissons_ratio)};
}

double distortion_energy(const Linear& law, const Eigen::Matrix3d& F) {
  const Eigen::Matrix3d eps = small_strain(F);
  const double trace = eps.trace();
  return law.shear_modulus_pa * eps.squaredNorm() +
         0.5 * negative_part(law.lame_lambda_pa) * trace * trace;
}

LocalResponse distortion_response(const Linear& law, const Eigen::Matrix3d& F) {
  const double mu = law.shear_modulus_pa;
  const double lambda = negative_part(law.lame_lambda_pa);
  const Eigen::Matrix3d eps = small_strain(F);
  const double trace = eps.trace();
  // P = 2 mu eps + lambda tr(eps) 1, dP = mu (dF + dF^T) + lambda tr(dF) 1.
  LocalResponse response;
  response.energy_density = mu * eps.squaredNorm() + 0.5 * lambda * trace * trace;
  response.stress = 2.0 * mu * eps + lambda * trace * Eigen::Matrix3d::Identity();
  response.tangent = mu * Tangent::Identity();
  for (int col = 0; col < 3; ++col) {
    for (int row = 0; row < 3; ++row) {
      response.tangent(3 * col + row, 3 * row + col) += mu;  // the transpose of dF
      response.tangent(4 * col, 4 * row) += lambda;
    }
  }
  return response;
}

VolumeTerm volume_term(const Linear& law) {
  return law.lame_lambda_pa > 0.0
             ? VolumeTerm{VolumeMeasure::kSmallTrace, law.lame_lambda_pa}
             : VolumeTerm{};
}

SmallStrainModuli small_strain_moduli(const Linear& law) {
  return {law.shear_modulus_pa, law.lame_lambda_pa + 2.0 / 3.0 * law.shear_modulus_pa};
}

double distortion_energy(const StVenantKirchhoff& law, const Eigen::Matrix3d& F) {
  const Eigen::Matrix3d E = 0.5 * twice_green_strain(F);
  const double trace = E.trace();
  return law.shear_modulus_pa * E.squaredNorm() +
         0.5 * negative_part(law.lame_lambda_pa) * trace * trace;
}

// P = F S, S = 2 mu E + lambda tr(E) 1, dP = dF S + F dS.
LocalResponse distortion_response(const StVenantKirchhoff& law,
                                  const Eigen::Matrix3d& F) {
  const double mu = law.shear_modulus_pa;
  const double lambda = negative_part(law.lame_lambda_pa);
  const Eigen::Matrix3d E = 0.5 * twice_green_strain(F);
  const double trace = E.trace();
  const Eigen::Matrix3d S = 2.0 * mu * E + lambda * trace * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d mu_FFt = mu * F * F.transpose();
  LocalResponse response;
  response.energy_density = mu * E.squaredNorm() + 0.5 * lambda * trace * trace;
  response.stress = F * S;
  for (int J = 0; J < 3; ++J) {
    for (int I = 0; I < 3; ++I) {
      auto block = response.tangent.block<3, 3>(3 * I, 3 * J);
      block = mu * F.col(J) * F.col(I).transpose();
      block += lambda * F.col(I) * F.col(J).transpose();
      block.diagonal().array() += S(I, J);
    }
    response.tangent.block<3, 3>(3 * J, 3 * J) += mu_FFt;
  }
  return response;
}

VolumeTerm volume_term(const StVenantKirchhoff& law) {
  return law.lame_lambda_pa > 0.0
             ? VolumeTerm{VolumeMeasure::kGreenTrace, law.lame_lambda_pa}
             : VolumeTerm{};
}

SmallStrainModuli small_strain_moduli(const StVenantKirchhoff& law) {
  return {law.shear_modulus_pa, law.lame_lambda_pa + 2.0 / 3.0 * law.shear_modulus_pa};
}

}  // namespace palpate
