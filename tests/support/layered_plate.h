// A plate of three layers under a needle, for tests that look at its page.
#pragma once

#include "formats/database/response_database.h"
#include "tests/support/sample_bodies.h"

namespace palpate {

inline constexpr double kLayerNeedleM = 0.002;  // radius of the ball that is pressed
inline constexpr double kLayerNPerM = 200.0;    // every node's response
inline constexpr double kLayerSkinN = 1.2;
inline constexpr double kLayerCutN = 0.2;  // of every layer

/// Skin over fat over muscle, beginning at 0, 5 and 20 mm. Membranes bear kLayerSkinN,
/// 0.4 and 0.7 N.
[[nodiscard]] inline ResponseDatabase layered_plate() {
  ResponseDatabase database = sample_database(
      plate(0.1, 20), ball(kLayerNeedleM, 0.0, 0.0),
      [](Eigen::Index, double d) {
        return kLayerNPerM * d;
      },
      0.01);
  Puncture& puncture = database.tools[0].puncture;
  puncture = {.rule = "force",
              .material = {"skin", "fat", "muscle"},
              .membrane_n = {kLayerSkinN, 0.4, 0.7},
              .cutting_n = {kLayerCutN, kLayerCutN, kLayerCutN},
              .friction_n_per_m = {5.0, 2.0, 10.0},
              .static_ratio = {1.2, 1.2, 1.2},
              .toughness_j_per_m2 = {400.0, 400.0, 400.0},
              .edge_width_m = 5e-4,
              .shaft_n_per_m = 2000.0,
              .lateral_n_per_m2 = 5e4,
              .mouth_m = 5e-4,
              .rupture = {kLayerSkinN}};
  puncture.layer_depth_m.resize(1, 3);
  puncture.layer_depth_m << 0.0, 0.005, 0.02;
  puncture.layer_material.resize(1, 3);
  puncture.layer_material << 0, 1, 2;
  return database;
}

}  // namespace palpate
