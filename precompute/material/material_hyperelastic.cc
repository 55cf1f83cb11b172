#include "precompute/material/material_hyperelastic.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/reproducible.h"
#include "precompute/material/material_check.h"
#include "precompute/material/strain_invariants.h"

namespace palpate {
namespace {

// I1 - 3
double first_excess(const Eigen::Matrix3d& F) {
  const Eigen::Matrix3d H = F - Eigen::Matrix3d::Identity();
  return 2.0 * H.trace() + H.squaredNorm();
}

// J^-p I - 3 from (I - 3) and J^-p - 1: the first-order parts cancel to rounding of the
// strain, not of 3.
double isochoric_excess(double invariant_excess, double scale_excess) {
  return invariant_excess * (1.0 + scale_excess) + 3.0 * scale_excess;
}

// tangent += factor d2 I2/dF2, I2 = (I1^2 - tr C^2)/2, C = F'F:
// d(2 (I1 F - F C)) = 2 (I1 dF + 2 (F:dF) F - dF C - F dF' F - F F' dF).
void add_second_invariant_curvature(const Eigen::Matrix3d& F, double I1, double factor,
                                    Tangent& tangent) {
  const double twice = 2.0 * factor;
  const Eigen::Matrix3d C = F.transpose() * F;
  const Eigen::Matrix3d B = F * F.transpose();
  for (int J = 0; J < 3; ++J) {
    for (int I = 0; I < 3; ++I) {
      auto block = tangent.block<3, 3>(3 * I, 3 * J);
      const Eigen::Vector3d f_I = twice * F.col(I);
      const Eigen::Vector3d f_J = twice * F.col(J);
      for (int j = 0; j < 3; ++j) {
        block.col(j) += (2.0 * F(j, J)) * f_I - F(j, I) * f_J;
      }
      block.diagonal().array() -= twice * C(I, J);
    }
    tangent.block<3, 3>(3 * J, 3 * J) -= twice * B;
  }
  tangent.diagonal().array() += twice * I1;
}

}  // namespace

NeoHookean neo_hookean(double youngs_modulus_pa, double poissons_ratio) {
  const double mu = shear_modulus_from(youngs_modulus_pa, poissons_ratio);
  return {mu, bulk_modulus_from(mu, poissons_ratio)};
}

MooneyRivlin mooney_rivlin(double c10_pa, double c01_pa, double poissons_ratio) {
  const double sum_pa = c10_pa + c01_pa;
  if (!(sum_pa > 0.0) || !std::isfinite(sum_pa)) {
    throw InputError(
        fmt::format("Mooney-Rivlin constants c10 {} Pa and c01 {} Pa; their sum "
                    "must be positive",
                    c10_pa, c01_pa));
  }
  check_poissons_ratio(poissons_ratio);
  return {c10_pa, c01_pa, bulk_modulus_from(2.0 * sum_pa, poissons_ratio)};
}

double distortion_energy(const NeoHookean& law, const Eigen::Matrix3d& F) {
  const auto [J, log_J] = volume_change(F);
  if (!(J > 0.0)) {
    return std::numeric_limits<double>::infinity();
  }
  const double scale_excess = reproducible::expm1(-2.0 / 3.0 * log_J);
  return finite_or_infinite(0.5 * law.shear_modulus_pa *
                            isochoric_excess(first_excess(F), scale_excess));
}

LocalResponse distortion_response(const NeoHookean& law, const Eigen::Matrix3d& F) {
  const auto [J, log_J] = volume_change(F);
  if (!(J > 0.0)) {
    return inadmissible();
  }
  // Psi = mu/2 (Ibar1 - 3), Ibar1 = J^(-2/3) I1. The tangent begins with mu J^(-2/3) 1,
  // the part of d2I1/dF2 = 2; add_isochoric has the others.
  const double mu = law.shear_modulus_pa;
  const double scale_excess = reproducible::expm1(-2.0 / 3.0 * log_J);
  const double scale = 1.0 + scale_excess;
  LocalResponse response{0.5 * mu * isochoric_excess(first_excess(F), scale_excess),
                         Eigen::Matrix3d::Zero(), mu * scale * Tangent::Identity()};
  add_isochoric(F, J, 0.5 * mu, 2.0 / 3.0, scale, F.squaredNorm(), 2.0 * F, response);
  return response;
}

VolumeTerm volume_term(const NeoHookean& law) {
  return {VolumeMeasure::kJacobian, law.bulk_modulus_pa};
}

SmallStrainModuli small_strain_moduli(const NeoHookean& law) {
  return {law.shear_modulus_pa, law.bulk_modulus_pa};
}

// With D = F'F - 1: I1 - 3 = tr D, I2 - 3 = 2 tr D + (tr^2 D - tr D^2)/2.
double distortion_energy(const MooneyRivlin& law, const Eigen::Matrix3d& F) {
  const auto [J, log_J] = volume_change(F);
  if (!(J > 0.0)) {
    return std::numeric_limits<double>::infinity();
  }
  const Eigen::Matrix3d D = twice_green_strain(F);
  const double trace = D.trace();
  const double excess2 = 2.0 * trace + second_invariant(D);
  return finite_or_infinite(
      law.c10_pa * isochoric_excess(trace, reproducible::expm1(-2.0 / 3.0 * log_J)) +
      law.c01_pa * isochoric_excess(excess2, reproducible::expm1(-4.0 / 3.0 * log_J)));
}

LocalResponse distortion_response(const MooneyRivlin& law, const Eigen::Matrix3d& F) {
  const auto [J, log_J] = volume_change(F);
  if (!(J > 0.0)) {
    return inadmissible();
  }
  // Psi = c10 (J^(-2/3) I1 - 3) + c01 (J^(-4/3) I2 - 3), dI2/dF = 2 (I1 F - F C).
  const double scale1 = reproducible::exp(-2.0 / 3.0 * log_J);
  const double scale2 = scale1 * scale1;
  const double I1 = F.squaredNorm();
  const Eigen::Matrix3d C = F.transpose() * F;
  const double I2 = second_invariant(C);
  LocalResponse response{distortion_energy(law, F), Eigen::Matrix3d::Zero(),
                         2.0 * law.c10_pa * scale1 * Tangent::Identity()};
  add_isochoric(F, J, law.c10_pa, 2.0 / 3.0, scale1, I1, 2.0 * F, response);
  add_second_invariant_curvature(F, I1, law.c01_pa * scale2, response.tangent);
  add_isochoric(F, J, law.c01_pa, 4.0 / 3.0, scale2, I2, 2.0 * (I1 * F - F * C),
                response);
  return response;
}

VolumeTerm volume_term(const MooneyRivlin& law) {
  return {VolumeMeasure::kJacobian, law.bulk_modulus_pa};
}

SmallStrainModuli small_strain_moduli(const MooneyRivlin& law) {
  return {2.0 * (law.c10_pa + law.c01_pa), law.bulk_modulus_pa};
}

}  // namespace palpate
