// A small database of every kind that there is: for tests of what writes and reads
// them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "formats/database/table_memory.h"
#include "tests/support/contact_database.h"
#include "tests/support/punctured_sphere.h"
#include "tests/support/small_database.h"
#include "tests/support/sphere_database.h"

namespace palpate {

/// Measured in two runs, one held; a tool that relaxes.
[[nodiscard]] inline ResponseDatabase measured_database() {
  ResponseDatabase database = small_database();
  database.measurement = held();
  database.tools[0].relaxation = relaxing();
  database.tools[1].viscoelasticity = viscous();
  return database;
}

/// A sphere in many chunks whose shares, yielding and sites differ everywhere.
[[nodiscard]] inline ResponseDatabase remembering_database() {
  ResponseDatabase database = sphere_database(8, 6);
  const auto n = static_cast<std::size_t>(database.body.position_m.rows());
  Viscoelasticity relaxes;
  relaxes.tau_s = {0.5, 4.0};
  relaxes.speed_m_per_s = 1e-3;
  relaxes.g = RowsOf<float>::Constant(database.body.position_m.rows(), 2, 0.2F);
  relaxes.error_relative.assign(n, 0.01F);
  relaxes.yielding = {.yield_depth_m = {0.001},
                      .share = std::vector<double>(n, 0.4),
                      .onset_m = {0.002},
                      .scale_m = {0.003},
                      .largest = {0.5}};
  give_memory(database.body, database.normal, relaxes, 1, database.tools[0]);
  database.storage.chunk_nodes = 40;
  return database;
}

/// Tilts, and a tool of two coupled contacts.
[[nodiscard]] inline ResponseDatabase coupled_database() {
  ResponseDatabase database = small_database();
  ResponseTable& tilted = database.tools[0];
  tilted.tilt = Points::Zero(6, 3);
  tilted.tilt_by_depth_per_m = Points::Zero(6, 3);
  tilted.tilt.row(2) =
      0.05 * Eigen::Vector3d(database.normal.row(2)).unitOrthogonal().transpose();
  ResponseTable& pads = database.tools[1];
  pads.tool.contact.point_m = Points::Zero(2, 3);
  pads.tool.contact.point_m(1, 0) = 0.012;
  pads.tool.contact.radius_m = {0.005, 0.005};
  pads.compliance.distance_m = log_spaced(0.002, 0.1, 4);
  pads.compliance.value = RowsOf<float>::Constant(6, 4, 1e-6F);
  pads.compliance.mode = RowsOf<float>::Constant(6, 2, 1e-4F);
  pads.compliance.error_relative = 0.03;
  return database;
}

[[nodiscard]] inline std::vector<std::pair<std::string, ResponseDatabase>>
every_database() {
  return {{"small", small_database()},
          {"measured", measured_database()},
          {"remembering", remembering_database()},
          {"coupled", coupled_database()},
          {"contacts", with_contacts()},
          {"punctured", punctured_sphere(true)}};
}

}  // namespace palpate
