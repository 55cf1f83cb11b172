// A needle's database: what the tests of its group share.
#pragma once

#include <cmath>
#include <limits>

#include "tests/support/sphere_database.h"

namespace palpate {

/// Three layers under some nodes and two under others; alike, or by node.
[[nodiscard]] inline Puncture some_puncture(std::int64_t nodes) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  Puncture puncture{.rule = "force",
                    .material = {"skin", "muscle", "bone"},
                    .membrane_n = {3.0, 0.6, std::numeric_limits<double>::infinity()},
                    .cutting_n = {0.5, 0.2, std::numeric_limits<double>::infinity()},
                    .friction_n_per_m = {15.0, 40.0, 0.0},
                    .static_ratio = {1.3, 1.2, 1.0},
                    .toughness_j_per_m2 = {2500.0, 400.0, kUnknown},
                    .edge_width_m = 5e-4,
                    .shaft_n_per_m = 2000.0,
                    .lateral_n_per_m2 = 5e4,
                    .mouth_m = 1e-3};
  puncture.layer_depth_m.resize(nodes, 3);
  puncture.layer_material.resize(nodes, 3);
  for (Eigen::Index i = 0; i < nodes; ++i) {
    puncture.rupture.push_back(2.0 + 0.01 * static_cast<double>(i));
    puncture.layer_depth_m.row(i) << 0.0, 0.002 + 1e-6 * static_cast<double>(i),
        i % 2 == 0 ? 0.01 : kUnknown;
    puncture.layer_material.row(i) << 0, 1, i % 2 == 0 ? 2 : -1;
  }
  return puncture;
}

/// The same of a needle whose own radius and tip are known, with a membrane that breaks
/// by energy.
[[nodiscard]] inline Puncture known_puncture(std::int64_t nodes) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  Puncture puncture = some_puncture(nodes);
  puncture.membrane_j = {kUnknown, 2e-3, kUnknown};
  puncture.radius_m = 7.5e-4;
  puncture.tip_angle_rad = 0.5235987755982988;  // 30 degrees
  puncture.insertable_m = 0.03;
  return puncture;
}

/// A sphere in many chunks under a needle.
[[nodiscard]] inline ResponseDatabase punctured_sphere(bool by_node) {
  ResponseDatabase database = sphere_database(24, 6);
  database.tools[0].puncture =
      some_puncture(by_node ? database.body.position_m.rows() : 1);
  database.storage.chunk_nodes = 100;
  return database;
}

}  // namespace palpate
