#include "precompute/material/material_spectrum.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>

#include "formats/base/reproducible.h"
#include "formats/response/viscoelasticity.h"

namespace palpate {
namespace {

constexpr int kFittedRates = 6;
constexpr double kSlowest = 1.0 / 5.0;  // of the longest time's rate
constexpr double kFastest = 3.0;        // of the shortest's

// `count` values in equal ratios, both ends with them.
std::vector<double> between(double first, double last, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    values.push_back(first * reproducible::pow(last / first, i / (count - 1.0)));
  }
  values.back() = last;
  return values;
}

}  // namespace

SceneSpectrum spectrum_of(const Scene& scene) {
  if (scene.material.empty()) {
    return {};
  }
  const SceneRelaxation& first = scene.material.front().relaxation;
  bool same = true;
  double shortest_s = std::numeric_limits<double>::infinity();
  double longest_s = 0.0;
  for (const SceneMaterial& material : scene.material) {
    const SceneRelaxation& relaxation = material.relaxation;
    same = same && relaxation == first;
    if (!relaxation.tau_s.empty()) {
      const double stays =
          1.0 - std::accumulate(relaxation.g.begin(), relaxation.g.end(), 0.0);
      shortest_s = std::min(shortest_s, relaxation.tau_s.front());
      longest_s = std::max(longest_s, relaxation.tau_s.back() / stays);
    }
  }
  // Springs that it stands on do not relax with a body.
  same = same &&
         (first.tau_s.empty() || std::all_of(scene.support.begin(), scene.support.end(),
                                             [](const SceneSupport& support) {
                                               return support.is_fixed();
                                             }));
  return same ? SceneSpectrum{first.tau_s, first.g}
              : SceneSpectrum{
                    between(shortest_s, longest_s, static_cast<int>(kMostTerms)), {}};
}

std::vector<double> fitted_rates_per_s(const std::vector<double>& tau_s) {
  return between(kSlowest / tau_s.back(), kFastest / tau_s.front(), kFittedRates);
}

Scene transformed_scene(const Scene& scene, double rate_per_s) {
  Scene relaxed = scene;
  for (SceneMaterial& material : relaxed.material) {
    // share = 1 - sum_k g_k / (1 + s tau_k), s = rate_per_s: the relaxation's
    // transform.
    double share = 1.0;
    for (std::size_t k = 0; k < material.relaxation.g.size(); ++k) {
      share -= material.relaxation.g[k] *
               relaxed_part(material.relaxation.tau_s[k], rate_per_s);
    }
    for (double* modulus : {&material.youngs_modulus_pa, &material.c10_pa,
                            &material.c01_pa, &material.youngs_modulus_fibre_pa,
                            &material.shear_modulus_fibre_pa, &material.k1_pa}) {
      *modulus *= share;
    }
    for (double& mu_pa : material.mu_pa) {
      mu_pa *= share;
    }
  }
  return relaxed;
}

}  // namespace palpate
