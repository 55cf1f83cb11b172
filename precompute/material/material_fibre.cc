#include "precompute/material/material_fibre.h"

#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/reproducible.h"
#include "precompute/material/material_check.h"
#include "precompute/material/material_hyperelastic.h"
#include "precompute/material/strain_invariants.h"

namespace palpate {
namespace {

Eigen::Vector3d checked_fibre(const Eigen::Vector3d& fibre) {
  const double length = fibre.stableNorm();
  if (!(length > 0.0) || !std::isfinite(length)) {
    throw InputError(
        fmt::format("fibre direction is ({}, {}, {}); must be finite and not zero",
                    fibre.x(), fibre.y(), fibre.z()));
  }
  return (fibre / length).normalized();
}

void check_moduli(const TransverseModuli& m) {
  check_positive_pa("Young's modulus along the fibre", m.youngs_along_pa);
  check_positive_pa("Young's modulus across the fibre", m.youngs_across_pa);
  check_positive_pa("shear modulus along the fibre", m.shear_along_pa);
  if (!(m.poisson_tt > -1.0 && m.poisson_tt < 1.0)) {
    throw InputError(
        fmt::format("Poisson's ratio across the fibre is {}; must lie between -1 "
                    "and 1, both excluded",
                    m.poisson_tt));
  }
  // The energy is positive where nu_lt^2 < (1 - nu_tt)/2 E_l/E_t (Lempriere 1968).
  const double limit =
      std::sqrt(0.5 * (1.0 - m.poisson_tt) * (m.youngs_along_pa / m.youngs_across_pa));
  if (!(std::abs(m.poisson_lt) < limit)) {
    throw InputError(
        fmt::format("Poisson's ratio from along to across the fibre is {}; must lie "
                    "between -{} and {} for these moduli, both excluded",
                    m.poisson_lt, limit, limit));
  }
}

// Stresses from stretches along the axes (fibre, across, across).
Eigen::Matrix3d axial_stiffness(const TransverseModuli& m) {
  // Strains from stresses: 1/E on the diagonal, -nu_lt/E_l and -nu_tt/E_t beside it.
  const double along = 1.0 / m.youngs_along_pa;
  const double across = 1.0 / m.youngs_across_pa;
  const double lt = -m.poisson_lt * along;
  const double tt = -m.poisson_tt * across;
  Eigen::Matrix3d compliance;
  compliance << along, lt, lt, lt, across, tt, lt, tt, across;
  return compliance.inverse();
}

Eigen::Matrix3d strain_of(const TransverselyIsotropic& law, const Eigen::Matrix3d& F) {
  if (law.finite_strain) {
    return 0.5 * twice_green_strain(F);
  }
  return 0.5 * (F + F.transpose()) - Eigen::Matrix3d::Identity();
}

// The fibres' energy density and its first two derivatives by x = Ibar4 - 1.
struct FibreEnergy {
  double value = 0.0;
  double slope = 0.0;
  double curvature = 0.0;
};

FibreEnergy fibre_energy(const FibreExponential& law, double x) {
  if (!(x > 0.0)) {
    return {};
  }
  const double exponent = law.k2 * x * x;
  const double growth = reproducible::exp(exponent);
  return {law.k1_pa * reproducible::expm1(exponent) / (2.0 * law.k2),
          law.k1_pa * x * growth, law.k1_pa * growth * (1.0 + 2.0 * exponent)};
}

// Ibar4 - 1 without cancellation: |F a0|^2 - 1 = a0.(F'F - 1) a0.
double fibre_excess(const FibreExponential& law, const Eigen::Matrix3d& F,
                    double log_J) {
  const double scale_excess = reproducible::expm1(-2.0 / 3.0 * log_J);
  const double excess = law.fibre.dot(twice_green_strain(F) * law.fibre);
  return excess * (1.0 + scale_excess) + scale_excess;
}

NeoHookean matrix_of(const FibreExponential& law) {
  return {law.shear_modulus_pa, law.bulk_modulus_pa};
}

}  // namespace

TransverselyIsotropic transversely_isotropic(const TransverseModuli& moduli,
                                             const Eigen::Vector3d& fibre,
                                             bool finite_strain) {
  const Eigen::Vector3d a0 = checked_fibre(fibre);
  check_moduli(moduli);
  // C = sum_ab D_ab (a a)(b b) + sum_pairs G_ab (a b + b a)(a b + b a), a and b unit
  // axes. D = axial_stiffness. G across the fibre follows from isotropy there: E_t / (2
  // (1 + nu_tt)).
  Eigen::Matrix3d axes;  // columns: fibre, across, across
  axes << a0, a0.unitOrthogonal(), a0.cross(a0.unitOrthogonal());
  const auto dyad = [&axes](int a, int b) -> Eigen::Matrix3d {
    return axes.col(a) * axes.col(b).transpose();
  };
  const Eigen::Matrix3d axial_pa = axial_stiffness(moduli);
  const double shear_across_pa =
      moduli.youngs_across_pa / (2.0 * (1.0 + moduli.poisson_tt));
  const std::array<double, 3> shear_pa{moduli.shear_along_pa, shear_across_pa,
                                       moduli.shear_along_pa};
  TransverselyIsotropic law;
  law.finite_strain = finite_strain;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      law.stiffness_pa +=
          axial_pa(a, b) * as_vector(dyad(a, a)) * as_vector(dyad(b, b)).transpose();
    }
    const int b = (a + 1) % 3;
    const Eigen::Matrix3d shear = dyad(a, b) + dyad(b, a);
    law.stiffness_pa += shear_pa[static_cast<std::size_t>(a)] * as_vector(shear) *
                        as_vector(shear).transpose();
  }
  return law;
}

TransverselyIsotropic transversely_isotropic(double youngs_along_pa,
                                             double youngs_across_pa,
                                             double shear_along_pa, double poisson_lt,
                                             double poisson_tt,
                                             const Eigen::Vector3d& fibre,
                                             bool finite_strain) {
  return transversely_isotropic(
      {youngs_along_pa, youngs_across_pa, shear_along_pa, poisson_lt, poisson_tt},
      fibre, finite_strain);
}

FibreExponential fibre_exponential(double youngs_modulus_pa, double poissons_ratio,
                                   double k1_pa, double k2,
                                   const Eigen::Vector3d& fibre) {
  const NeoHookean matrix = neo_hookean(youngs_modulus_pa, poissons_ratio);
  if (!(k1_pa >= 0.0) || !std::isfinite(k1_pa)) {
    throw InputError(
        fmt::format("fibre modulus k1 is {} Pa; must not be negative", k1_pa));
  }
  if (!(k2 > 0.0) || !std::isfinite(k2)) {
    throw InputError(fmt::format("fibre exponent k2 is {}; must be positive", k2));
  }
  return {matrix.shear_modulus_pa, matrix.bulk_modulus_pa, k1_pa, k2,
          checked_fibre(fibre)};
}

double distortion_energy(const TransverselyIsotropic& law, const Eigen::Matrix3d& F) {
  const Eigen::Matrix3d strain = strain_of(law, F);
  return 0.5 * as_vector(strain).dot(law.stiffness_pa * as_vector(strain));
}

// Green strain: P = F S, S = C:E, dP = dF S + F (C:(F' dF)); C has both minor
// symmetries.
LocalResponse distortion_response(const TransverselyIsotropic& law,
                                  const Eigen::Matrix3d& F) {
  const Eigen::Matrix3d strain = strain_of(law, F);
  Eigen::Matrix3d S;
  Eigen::Map<Vector9>(S.data()).noalias() = law.stiffness_pa * as_vector(strain);
  LocalResponse response;
  response.energy_density = 0.5 * as_vector(strain).dot(as_vector(S));
  if (!law.finite_strain) {
    response.stress = S;
    response.tangent = law.stiffness_pa;
    return response;
  }
  response.stress = F * S;
  for (int J = 0; J < 3; ++J) {
    for (int I = 0; I < 3; ++I) {
      auto block = response.tangent.block<3, 3>(3 * I, 3 * J);
      block.noalias() = F * law.stiffness_pa.block<3, 3>(3 * I, 3 * J) * F.transpose();
      block.diagonal().array() += S(I, J);
    }
  }
  return response;
}

VolumeTerm volume_term(const TransverselyIsotropic& /*law*/) {
  return {};
}

// Voigt: K = C_iijj/9, mu = (C_ijij - C_iijj/3)/10.
SmallStrainModuli small_strain_moduli(const TransverselyIsotropic& law) {
  double bulk9_pa = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      bulk9_pa += law.stiffness_pa(4 * i, 4 * j);
    }
  }
  return {(law.stiffness_pa.trace() - bulk9_pa / 3.0) / 10.0, bulk9_pa / 9.0};
}

double distortion_energy(const FibreExponential& law, const Eigen::Matrix3d& F) {
  const auto [J, log_J] = volume_change(F);
  if (!(J > 0.0)) {
    return std::numeric_limits<double>::infinity();
  }
  const double energy = distortion_energy(matrix_of(law), F) +
                        fibre_energy(law, fibre_excess(law, F, log_J)).value;
  return finite_or_infinite(energy);
}

LocalResponse distortion_response(const FibreExponential& law,
                                  const Eigen::Matrix3d& F) {
  LocalResponse response = distortion_response(matrix_of(law), F);
  const auto [J, log_J] = volume_change(F);
  if (!(J > 0.0)) {
    return response;
  }
  const double x = fibre_excess(law, F, log_J);
  const FibreEnergy fibre = fibre_energy(law, x);
  if (!(x >= 0.0)) {  // at rest fibres count as pulled
    return response;
  }
  if (!std::isfinite(fibre.curvature)) {
    return inadmissible();
  }
  // Ibar4 = J^(-2/3) I4, I4 = |F a0|^2. P += psi' dIbar4/dF, and A += psi' d2Ibar4/dF2
  // + psi'' dIbar4/dF dIbar4/dF, primes by x = Ibar4 - 1.
  const double scale = reproducible::exp(-2.0 / 3.0 * log_J);
  const Eigen::Vector3d a = F * law.fibre;
  const Eigen::Matrix3d dI4 = 2.0 * a * law.fibre.transpose();
  const double I4 = a.squaredNorm();
  response.energy_density += fibre.value;
  add_isochoric(F, J, fibre.slope, 2.0 / 3.0, scale, I4, dI4, response);
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {  // d2I4/dF2
      response.tangent.block<3, 3>(3 * i, 3 * j).diagonal().array() +=
          2.0 * fibre.slope * scale * law.fibre[i] * law.fibre[j];
    }
  }
  const Eigen::Matrix3d dIbar4 = scale * (dI4 - (2.0 / 3.0 * I4 / J) * cofactor(F));
  response.tangent +=
      fibre.curvature * as_vector(dIbar4) * as_vector(dIbar4).transpose();
  return response;
}

VolumeTerm volume_term(const FibreExponential& law) {
  return {VolumeMeasure::kJacobian, law.bulk_modulus_pa};
}

// At small strain the fibres store 2 k1 (a0.dev(eps) a0)^2: the stiffness
// 4 k1 dev(A) dev(A), A = a0 a0, whose Voigt shear modulus is 4 k1 |dev A|^2/10.
SmallStrainModuli small_strain_moduli(const FibreExponential& law) {
  return {law.shear_modulus_pa + 4.0 / 15.0 * law.k1_pa, law.bulk_modulus_pa};
}

}  // namespace palpate
