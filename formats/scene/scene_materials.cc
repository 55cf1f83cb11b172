// [[material]]: what the regions are made of.
#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/scene/scene_parts.h"

namespace palpate::scene_parts {
namespace {

constexpr std::string_view kMaterialKeys[] = {"region",
                                              "law",
                                              "youngs_modulus_pa",
                                              "poissons_ratio",
                                              "c10_pa",
                                              "c01_pa",
                                              "mu_pa",
                                              "alpha",
                                              "fibre",
                                              "fibre_law",
                                              "youngs_modulus_fibre_pa",
                                              "shear_modulus_fibre_pa",
                                              "poissons_ratio_fibre",
                                              "finite_strain",
                                              "k1_pa",
                                              "k2",
                                              "relaxation",
                                              "plastic",
                                              "damage",
                                              "puncture"};
constexpr std::string_view kSharedLawKeys[] = {"region",  "law",    "relaxation",
                                               "plastic", "damage", "puncture"};
constexpr std::string_view kIsotropicKeys[] = {"youngs_modulus_pa", "poissons_ratio"};
constexpr std::string_view kMooneyKeys[] = {"c10_pa", "c01_pa", "poissons_ratio"};
constexpr std::string_view kOgdenKeys[] = {"mu_pa", "alpha", "poissons_ratio"};
constexpr std::string_view kLinearFibreKeys[] = {"fibre",
                                                 "fibre_law",
                                                 "youngs_modulus_fibre_pa",
                                                 "youngs_modulus_pa",
                                                 "shear_modulus_fibre_pa",
                                                 "poissons_ratio_fibre",
                                                 "poissons_ratio",
                                                 "finite_strain"};
constexpr std::string_view kExponentialFibreKeys[] = {
    "fibre", "fibre_law", "youngs_modulus_pa", "poissons_ratio", "k1_pa", "k2"};
constexpr std::string_view kLaws[] = {"linear",      "st-venant-kirchhoff",
                                      "neo-hookean", "mooney-rivlin",
                                      "ogden",       "transversely-isotropic"};
constexpr std::string_view kFibreLaws[] = {"linear", "exponential"};
constexpr std::size_t kMostMaterialTerms = 4;

constexpr NumberRule kNotZero{[](double v) {
                                return v != 0.0;
                              },
                              "finite and not zero"};
constexpr NumberRule kPoissonAcross{[](double v) {
                                      return v > -1.0 && v < 1.0;
                                    },
                                    "above -1 and below 1"};

void read_isotropic(const SceneSection& section, SceneMaterial& material) {
  material.youngs_modulus_pa = section.number("youngs_modulus_pa", kPositive);
  material.poissons_ratio = section.number("poissons_ratio", kPoisson);
}

void read_mooney(const SceneSection& section, SceneMaterial& material) {
  material.c10_pa = section.number("c10_pa", kNotNegative);
  material.c01_pa = section.number("c01_pa", kNotNegative);
  material.poissons_ratio = section.number("poissons_ratio", kPoisson);
  if (!(material.c10_pa + material.c01_pa > 0.0)) {
    section.fail(section.need("c10_pa"),
                 "c10_pa and c01_pa in [[material]] are both 0, one must be positive");
  }
}

void read_ogden(const SceneSection& section, SceneMaterial& material) {
  material.mu_pa = section.numbers("mu_pa", kNotZero, kMostMaterialTerms);
  material.alpha = section.numbers("alpha", kNotZero, kMostMaterialTerms);
  material.poissons_ratio = section.number("poissons_ratio", kPoisson);
  if (material.mu_pa.size() != material.alpha.size()) {
    section.fail(section.need("alpha"),
                 "alpha in [[material]] has {} numbers, must have as many as mu_pa: {}",
                 material.alpha.size(), material.mu_pa.size());
  }
  for (std::size_t i = 0; i < material.mu_pa.size(); ++i) {
    if (!(material.mu_pa[i] * material.alpha[i] > 0.0)) {
      section.fail(section.need("mu_pa"),
                   "mu_pa {} and alpha {} in [[material]] are of different signs, must "
                   "be of the same: else the body is not stable",
                   material.mu_pa[i], material.alpha[i]);
    }
  }
}

void read_linear_fibre(const SceneSection& section, SceneMaterial& material) {
  material.youngs_modulus_fibre_pa =
      section.number("youngs_modulus_fibre_pa", kPositive);
  material.youngs_modulus_pa = section.number("youngs_modulus_pa", kPositive);
  material.shear_modulus_fibre_pa = section.number("shear_modulus_fibre_pa", kPositive);
  material.poissons_ratio_fibre = section.number("poissons_ratio_fibre", kAny);
  material.poissons_ratio = section.number("poissons_ratio", kPoissonAcross);
  material.finite_strain = section.boolean_or(false, "finite_strain");
  // The compliance is positive definite: Lempriere 1968.
  const double bound = 1.0 - material.poissons_ratio -
                       2.0 * material.poissons_ratio_fibre *
                           material.poissons_ratio_fibre * material.youngs_modulus_pa /
                           material.youngs_modulus_fibre_pa;
  if (!(bound > 0.0)) {
    section.fail(section.need("poissons_ratio_fibre"),
                 "poissons_ratio_fibre {} and poissons_ratio {} in [[material]] give "
                 "1 - nu_tt - 2 nu_lt^2 E_t / E_l = {}, must be positive",
                 material.poissons_ratio_fibre, material.poissons_ratio, bound);
  }
}

void read_fibre(const SceneSection& section, SceneMaterial& material) {
  material.fibre_law = section.choice("fibre_law", kFibreLaws);
  const bool linear = material.fibre_law == "linear";
  section.require_own(
      fmt::format("law {:?} with fibre_law {:?}", material.law, material.fibre_law),
      linear ? Names(kLinearFibreKeys) : Names(kExponentialFibreKeys), kSharedLawKeys);
  material.fibre = section.direction("fibre");
  if (linear) {
    read_linear_fibre(section, material);
  } else {
    read_isotropic(section, material);
    material.k1_pa = section.number("k1_pa", kPositive);
    material.k2 = section.number("k2", kPositive);
  }
}

void read_law(const SceneSection& section, SceneMaterial& material) {
  const auto require_own = [&](Names own) {
    section.require_own(fmt::format("law {:?}", material.law), own, kSharedLawKeys);
  };
  if (material.law == "transversely-isotropic") {
    read_fibre(section, material);
  } else if (material.law == "mooney-rivlin") {
    require_own(kMooneyKeys);
    read_mooney(section, material);
  } else if (material.law == "ogden") {
    require_own(kOgdenKeys);
    read_ogden(section, material);
  } else {
    require_own(kIsotropicKeys);
    read_isotropic(section, material);
  }
}

constexpr std::string_view kRelaxationKeys[] = {"g", "tau_s"};

// The terms are in order, and something of the force stays.
void read_relaxation(const SceneSection& section, SceneMaterial& material) {
  if (section.find("relaxation") == nullptr) {
    return;
  }
  const SceneSection terms = section.table("relaxation", kRelaxationKeys);
  SceneRelaxation& relaxation = material.relaxation;
  relaxation.g = terms.numbers("g", kFraction, kMostMaterialTerms);
  relaxation.tau_s = terms.numbers("tau_s", kPositive, kMostMaterialTerms);
  if (relaxation.g.size() != relaxation.tau_s.size()) {
    terms.fail(terms.need("tau_s"),
               "tau_s in {} has {} numbers, must have as many as g: {}", terms.title(),
               relaxation.tau_s.size(), relaxation.g.size());
  }
  for (std::size_t k = 1; k < relaxation.tau_s.size(); ++k) {
    if (!(relaxation.tau_s[k] > relaxation.tau_s[k - 1])) {
      terms.fail(terms.need("tau_s"), "tau_s in {} has {} after {}, must increase",
                 terms.title(), relaxation.tau_s[k], relaxation.tau_s[k - 1]);
    }
  }
  const double sum = std::accumulate(relaxation.g.begin(), relaxation.g.end(), 0.0);
  if (!(sum < 1.0)) {
    terms.fail(terms.need("g"),
               "g in {} sums to {:.6g}, must stay below 1: a force that is held for "
               "long is 1 - sum of g of the sudden one",
               terms.title(), sum);
  }
}

// Names of regions that have a material: the body, and inclusions that are no holes.
std::vector<std::string_view> solid_regions(const Scene& scene) {
  std::vector<std::string_view> regions{kBodyRegion};
  for (const SceneInclusion& inclusion : scene.inclusion) {
    if (!inclusion.cavity) {
      regions.push_back(inclusion.name);
    }
  }
  return regions;
}

}  // namespace

void read_materials(const Sections& sections, Scene& scene) {
  const std::vector<std::string_view> regions = solid_regions(scene);
  for (const SceneSection& section : sections.all("material", kMaterialKeys)) {
    SceneMaterial material;
    material.region = section.choice("region", regions);
    material.law = section.choice("law", kLaws);
    read_law(section, material);
    read_relaxation(section, material);
    material.yielding = read_yielding(section);
    material.puncture = read_puncture(section);
    for (const SceneMaterial& other : scene.material) {
      if (other.region == material.region) {
        section.fail("region {:?} has two materials, must have one", material.region);
      }
    }
    scene.material.push_back(std::move(material));
  }
  for (const std::string_view region : regions) {
    if (std::none_of(scene.material.begin(), scene.material.end(),
                     [&](const SceneMaterial& material) {
                       return material.region == region;
                     })) {
      throw InputError(fmt::format("{}: region {:?} has no [[material]], must have one",
                                   sections.file().name, region));
    }
  }
}

}  // namespace palpate::scene_parts
