#include "precompute/build/plan_relaxation.h"

#include "precompute/material/material_spectrum.h"

namespace palpate {

void plan_relaxation(const Scene& scene, PlanReport& report) {
  const SceneSpectrum spectrum = spectrum_of(scene);
  if (spectrum.empty() || spectrum.uniform()) {
    return;
  }
  double linear_s = 0.0;
  for (std::size_t i = 1; i < report.cost.size(); ++i) {
    linear_s += report.cost[i].seconds;
  }
  const std::size_t rates = fitted_rates_per_s(spectrum.tau_s).size() + 1;
  report.cost.push_back(
      cost_of_all("rates at which relaxation is fitted", rates, 1, linear_s));
}

}  // namespace palpate
