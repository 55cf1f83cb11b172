// How the materials of a scene relax, and the elastic scene that stands for it.
//
// Correspondence principle. The Laplace-Carson transform of a function of time F(t) is
// F(s) = s integral of exp(-s t) F(t) dt at a real rate s > 0. Roughly, F(s) is F at
// the time 1 / s. The response of a linear viscoelastic body to a sudden press has a
// transform. This transform is the response of the elastic body whose moduli are the
// transforms of the relaxing ones. The transform of 1 - sum g_k (1 - exp(-t / tau_k))
// is 1 - sum g_k / (1 + s tau_k).
#pragma once

#include <vector>

#include "formats/scene/scene.h"

namespace palpate {

/// Relaxation times that the responses of a scene have in common.
struct SceneSpectrum {
  std::vector<double> tau_s;  ///< (K) [s] increasing; none: nothing relaxes
  /// (K) [-] where all of the body relaxes so; empty where parts differ.
  std::vector<double> g;

  [[nodiscard]] bool empty() const { return tau_s.empty(); }
  [[nodiscard]] bool uniform() const { return !g.empty(); }
};

/// Spectrum of all materials: theirs where they agree and nothing stands on springs,
/// which do not relax. Else four times in equal ratios, from the shortest to the
/// longest over 1 - sum g of its material. A body of several materials relaxes with
/// times between those in which each relaxes and those in which it creeps.
[[nodiscard]] SceneSpectrum spectrum_of(const Scene& scene);

/// Rates at which a fit of relaxation looks [1/s]: six in equal ratios, from a fifth of
/// the longest time's to three of the shortest's. @param tau_s at least one,
/// increasing.
[[nodiscard]] std::vector<double> fitted_rates_per_s(const std::vector<double>& tau_s);

/// Transform of a term's 1 - exp(-t / tau) [-]. @param rate_per_s [1/s] >= 0
[[nodiscard]] inline double relaxed_part(double tau_s, double rate_per_s) {
  return 1.0 / (1.0 + rate_per_s * tau_s);
}

/// The scene with every modulus transformed. Ratios and exponents stay.
/// @param rate_per_s [1/s] >= 0; infinite: as the scene is.
[[nodiscard]] Scene transformed_scene(const Scene& scene, double rate_per_s);

}  // namespace palpate
