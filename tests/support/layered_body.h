// A needle, and a body of three layers that it punctures.
#pragma once

#include <cmath>
#include <limits>
#include <memory>

#include "runtime/bench/bench_body.h"
#include "runtime/fast/fast_step.h"

namespace palpate {

inline constexpr double kNeedleRadiusM = 0.0005;
inline constexpr double kNeedleMuchN = 1e9;
// f(e) = 5 N (e / 12 mm)^1.5; membranes 3, 0.6, 1.5 N; cutting 0.5, 0.2, 0.4 N.
inline constexpr double kLayeredN = 5.0;
inline constexpr double kLayeredM = 0.012;
inline constexpr double kSkinN = 3.0;
inline constexpr double kShaftNPerM = 400.0;
inline constexpr double kStaticRatio = 1.3;

inline PunctureRules layered_rules() {
  PunctureRules rules;
  rules.materials = 3;
  rules.material[0] = {kSkinN, 0.5, 20.0, kStaticRatio};
  rules.material[1] = {0.6, 0.2, 10.0, kStaticRatio};
  rules.material[2] = {1.5, 0.4, 15.0, kStaticRatio};
  rules.shaft_n_per_m = kShaftNPerM;
  rules.lateral_n_per_m2 = 5e3;
  rules.mouth_m = 2.0 * kNeedleRadiusM;
  return rules;
}

inline NodePuncture layered_node(double rupture) {
  NodePuncture node;
  node.layers = 3;
  node.rupture = rupture;
  node.depth_m = {0.0, 0.002, 0.012};
  node.material = {0, 1, 2};
  return node;
}

inline BenchBodyOptions layered_options() {
  BenchBodyOptions options;
  options.force_n = kLayeredN;
  options.depth_m = kLayeredM;
  options.cells = 4;
  options.cell_m = 0.01;
  options.touch_height_m = kNeedleRadiusM;
  return options;
}

inline BenchBody punctured_body(const BenchBodyOptions& options,
                                double rupture = kSkinN) {
  BenchBody body = make_bench_body(options);
  for (Element& element : body.element) {
    element.puncture.fill(layered_node(rupture));
  }
  return body;
}

inline double layered_n(double e) {
  return e > 0.0 ? kLayeredN * std::pow(e / kLayeredM, 1.5) : 0.0;
}

// Depth at which the curve has a force.
inline double layered_m(double force_n) {
  return kLayeredM * std::pow(force_n / kLayeredN, 1 / 1.5);
}

inline std::unique_ptr<FastState> needle_state(
    const PunctureRules& rules = layered_rules()) {
  auto state = std::make_unique<FastState>();
  state->config.model = LocalModel::kPotential;
  state->config.tool_radius_m = kNeedleRadiusM;
  state->config.force_max_n = kNeedleMuchN;
  state->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  state->config.puncture = rules;
  return state;
}

}  // namespace palpate
