// One material of every law, all of about 2 kPa of shear modulus.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "precompute/material/material.h"

namespace palpate {

struct NamedLaw {
  std::string name;
  Material law;
};

inline std::vector<NamedLaw> every_law() {
  const std::array mu_pa{1800.0, -500.0};
  const std::array alpha{1.7, -1.3};
  const Eigen::Vector3d fibre = Eigen::Vector3d::UnitX();
  return {{"Linear", linear(5800.0, 0.45)},
          {"StVenantKirchhoff", st_venant_kirchhoff(5800.0, 0.45)},
          {"NeoHookean", neo_hookean(5800.0, 0.45)},
          {"MooneyRivlin", mooney_rivlin(700.0, 300.0, 0.45)},
          {"Ogden", ogden(mu_pa, alpha, 0.45)},
          {"FibresLinear",
           transversely_isotropic(2e4, 5800.0, 2000.0, 0.4, 0.3, fibre, true)},
          {"FibreExponential", fibre_exponential(5800.0, 0.45, 5000.0, 1.0, fibre)}};
}

}  // namespace palpate
