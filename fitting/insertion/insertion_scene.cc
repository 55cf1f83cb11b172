#include "fitting/insertion/insertion_scene.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "fitting/insertion/toughness.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

double needed(const IntervalEstimate& estimate, const std::string& what) {
  if (!estimate.refused.empty()) {
    throw InputError(fmt::format("a scene needs {}, which was not found: {}", what,
                                 estimate.refused));
  }
  return estimate.value;
}

// Keys of a scene have ranges, which the noise of an estimate may leave.
std::string key(const char* name, const IntervalEstimate& estimate, double least) {
  return estimate.refused.empty()
             ? fmt::format(", {} = {:.6g}", name, std::max(least, estimate.value))
             : std::string();
}

std::string refusal_of(const char* name, const IntervalEstimate& estimate) {
  return estimate.refused.empty() ? std::string()
                                  : fmt::format("# {}: {}\n", name, estimate.refused);
}

std::string material(const NeedleFit& fit, std::size_t k, double edge_width_m,
                     const std::string& region) {
  const FittedLayer& layer = fit.layers[k];
  (void)needed(layer.cutting_n, fmt::format("the cutting force of layer {}", k + 1));
  const IntervalEstimate toughness = toughness_of(layer.cutting_n, edge_width_m);
  const IntervalEstimate& membrane_n = fit.ruptures[k].force_n;
  const std::string ratio = layer.friction_n_per_m.refused.empty()
                                ? key("static_ratio", fit.static_ratio, 1.0)
                                : std::string();
  return fmt::format(
      "[[material]]  # add law, youngs_modulus_pa, poissons_ratio\n"
      "region = \"{}\"\n{}{}{}"
      "puncture = {{ toughness_j_per_m2 = {:.6g}{}{}{} }}\n\n",
      region, refusal_of("friction_n_per_m", layer.friction_n_per_m),
      refusal_of("membrane_n", membrane_n),
      refusal_of("static_ratio", fit.static_ratio), std::max(0.0, toughness.value),
      key("friction_n_per_m", layer.friction_n_per_m, 0.0), ratio,
      key("membrane_n", membrane_n, 0.0));
}

}  // namespace

std::string insertion_scene(const NeedleFit& fit, double edge_width_m) {
  std::string text;
  const std::size_t last = fit.layers.size() - 1;
  double above_m = 0.0;
  for (std::size_t k = 0; k < last; ++k) {
    const double end_m = needed(fit.ruptures[k + 1].boundary_m,
                                fmt::format("the boundary below layer {}", k + 1));
    text += fmt::format("[[layer]]\nname = \"layer{}\"\nthickness_m = {:.6g}\n\n",
                        k + 1, end_m - above_m);
    above_m = end_m;
  }
  for (std::size_t k = 0; k <= last; ++k) {
    text += material(fit, k, edge_width_m,
                     k == last ? std::string("body") : fmt::format("layer{}", k + 1));
  }
  text += fmt::format(
      "[[tool]]  # add radius_m\nname = \"needle\"\nshape = \"needle\"\n"
      "edge_width_m = {:.6g}\n{}",
      edge_width_m, refusal_of("shaft_n_per_m", fit.presliding_n_per_m));
  if (fit.presliding_n_per_m.refused.empty() && fit.presliding_n_per_m.value > 0.0) {
    text += fmt::format("puncture = {{ shaft_n_per_m = {:.6g} }}\n",
                        fit.presliding_n_per_m.value);
  }
  return text;
}

}  // namespace palpate
