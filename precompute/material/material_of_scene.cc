#include "precompute/material/material_of_scene.h"

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

Material law_of(const SceneMaterial& m) {
  if (m.law == "st-venant-kirchhoff") {
    return st_venant_kirchhoff(m.youngs_modulus_pa, m.poissons_ratio);
  }
  if (m.law == "neo-hookean") {
    return neo_hookean(m.youngs_modulus_pa, m.poissons_ratio);
  }
  if (m.law == "mooney-rivlin") {
    return mooney_rivlin(m.c10_pa, m.c01_pa, m.poissons_ratio);
  }
  if (m.law == "ogden") {
    return ogden(m.mu_pa, m.alpha, m.poissons_ratio);
  }
  if (m.law == "transversely-isotropic" && m.fibre_law == "exponential") {
    return fibre_exponential(m.youngs_modulus_pa, m.poissons_ratio, m.k1_pa, m.k2,
                             m.fibre);
  }
  if (m.law == "transversely-isotropic") {
    return transversely_isotropic(m.youngs_modulus_fibre_pa, m.youngs_modulus_pa,
                                  m.shear_modulus_fibre_pa, m.poissons_ratio_fibre,
                                  m.poissons_ratio, m.fibre, m.finite_strain);
  }
  return linear(m.youngs_modulus_pa, m.poissons_ratio);
}

}  // namespace

Material make_material(const SceneMaterial& material) {
  try {
    return law_of(material);
  } catch (const InputError& error) {
    throw InputError(
        fmt::format("material of region {:?}: {}", material.region, error.what()));
  }
}

}  // namespace palpate
