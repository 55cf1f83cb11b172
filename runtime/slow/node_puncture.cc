#include "runtime/slow/node_puncture.h"

#include <cmath>
#include <cstddef>

namespace palpate {
namespace {

static_assert(kMostPunctureMaterials == kPunctureMaterials &&
              kMostPunctureLayers == static_cast<std::int64_t>(kPunctureLayers));

// Row of a node, of rows of all nodes or one for all.
std::int64_t row_in(std::int64_t rows, std::int64_t node) {
  return rows == 1 ? 0 : node;
}

}  // namespace

PunctureRules puncture_rules(const Puncture& puncture, double force_scale) {
  PunctureRules rules;
  rules.materials = static_cast<std::int32_t>(puncture.material.size());
  if (rules.materials == 0) {
    return rules;
  }
  for (std::size_t m = 0; m < puncture.material.size(); ++m) {
    rules.material[m] = {static_cast<Real>(force_scale * puncture.membrane_n[m]),
                         static_cast<Real>(force_scale * puncture.cutting_n[m]),
                         static_cast<Real>(force_scale * puncture.friction_n_per_m[m]),
                         static_cast<Real>(puncture.static_ratio[m])};
    if (const double membrane_j = membrane_j_of(puncture, m); membrane_j >= 0.0) {
      rules.material[m].membrane_j = static_cast<Real>(force_scale * membrane_j);
    }
  }
  rules.by_energy = puncture.rule == "energy";
  rules.shaft_n_per_m = static_cast<Real>(force_scale * puncture.shaft_n_per_m);
  rules.lateral_n_per_m2 = static_cast<Real>(force_scale * puncture.lateral_n_per_m2);
  rules.mouth_m = static_cast<Real>(puncture.mouth_m);
  return rules;
}

NodePuncture node_puncture(const Puncture& puncture, std::int64_t node,
                           double force_scale) {
  NodePuncture below;
  if (puncture.empty()) {
    return below;
  }
  const auto ruptures = static_cast<std::int64_t>(puncture.rupture.size());
  below.rupture = static_cast<Real>(
      force_scale * puncture.rupture[static_cast<std::size_t>(row_in(ruptures, node))]);
  const std::int64_t row = row_in(puncture.layer_depth_m.rows(), node);
  for (Eigen::Index k = 0; k < puncture.layer_depth_m.cols(); ++k) {
    const double depth_m = puncture.layer_depth_m(row, k);
    if (!std::isfinite(depth_m)) {
      break;
    }
    const auto layer = static_cast<std::size_t>(below.layers++);
    below.depth_m[layer] = static_cast<Real>(depth_m);
    below.material[layer] = static_cast<std::int8_t>(puncture.layer_material(row, k));
  }
  return below;
}

}  // namespace palpate
