#include "precompute/material/material.h"

#include "precompute/material/strain_invariants.h"

namespace palpate {
namespace {

VolumeTerm volume_term_of(const Material& material) {
  return std::visit(
      [](const auto& law) {
        return volume_term(law);
      },
      material);
}

SmallStrainModuli moduli_of(const Material& material) {
  return std::visit(
      [](const auto& law) {
        return small_strain_moduli(law);
      },
      material);
}

}  // namespace

double distortion_energy(const Material& material, const Eigen::Matrix3d& F) {
  return std::visit(
      [&F](const auto& law) {
        return distortion_energy(law, F);
      },
      material);
}

LocalResponse distortion_response(const Material& material, const Eigen::Matrix3d& F) {
  return std::visit(
      [&F](const auto& law) {
        return distortion_response(law, F);
      },
      material);
}

VolumeMeasure volume_measure(const Material& material) {
  return volume_term_of(material).measure;
}

double volume_modulus_pa(const Material& material) {
  return volume_term_of(material).modulus_pa;
}

bool has_kink(const Material& material) {
  return std::holds_alternative<FibreExponential>(material);
}

bool is_linear(const Material& material) {
  const auto* oriented = std::get_if<TransverselyIsotropic>(&material);
  return std::holds_alternative<Linear>(material) ||
         (oriented != nullptr && !oriented->finite_strain);
}

LocalResponse response(const Material& material, const Eigen::Matrix3d& F) {
  LocalResponse local = distortion_response(material, F);
  const VolumeTerm term = volume_term_of(material);
  if (term.measure == VolumeMeasure::kNone) {
    return local;
  }
  const VolumeResponse volume = volume_response(term.measure, F);
  const double pressure_pa = term.modulus_pa * volume.theta;
  const auto g = as_vector(volume.gradient);
  local.energy_density += 0.5 * pressure_pa * volume.theta;
  local.stress += pressure_pa * volume.gradient;
  local.tangent += term.modulus_pa * g * g.transpose() + pressure_pa * volume.curvature;
  return local;
}

double small_shear_modulus_pa(const Material& material) {
  return moduli_of(material).shear_pa;
}

// E = 9 K mu / (3 K + mu)
double small_youngs_modulus_pa(const Material& material) {
  const auto [shear_pa, bulk_pa] = moduli_of(material);
  return 9.0 * bulk_pa * shear_pa / (3.0 * bulk_pa + shear_pa);
}

}  // namespace palpate
