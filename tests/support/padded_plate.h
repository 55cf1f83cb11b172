// A plate pressed by a tool of several pads, with compliance between them.
#pragma once

#include "formats/database/response_database.h"
#include "tests/support/sample_bodies.h"

namespace palpate {

inline constexpr double kPadRadius = 0.005;

/// `pads` spheres in a row along x, 12 mm apart, their middle the reference point.
inline ToolShape pads(int count) {
  ToolShape tool = ball(kPadRadius, 0.3, 2e-3);
  tool.name = "pads";
  tool.contact.point_m = Points(count, 3);
  for (int i = 0; i < count; ++i) {
    tool.contact.point_m.row(i) << 0.012 * (i - 0.5 * (count - 1)), 0.0, 0.0;
    tool.contact.radius_m.push_back(kPadRadius);
  }
  return tool;
}

/// c(r) = 2e-5 m^2/N / r, as a half-space of E* = 16 kPa, at every node.
inline ComplianceTable half_space(std::int64_t nodes) {
  ComplianceTable table;
  table.distance_m = log_spaced(0.004, 0.1, 12);
  table.value = RowsOf<float>::Constant(nodes, 12, 2e-5F);
  table.convex = true;
  return table;
}

/// Plate of 0.1 m with tools "pads" (of `count` spheres) and "ball", both of f = 2e4
/// d^2 and half_space(). @param table whether there is one.
inline ResponseDatabase padded_plate(int count = 3, bool table = true) {
  const auto soft = [](Eigen::Index, double d) {
    return 2e4 * d * d;
  };
  ResponseDatabase database =
      sample_database(plate(0.1, 20), ball(kPadRadius, 0.3, 2e-3), soft, 0.01, 41);
  database.tools.push_back(database.tools[0]);
  database.tools[1].tool = pads(count);
  for (ResponseTable& each : database.tools) {
    if (table) {
      each.compliance = half_space(each.nodes());
    }
  }
  return database;
}

}  // namespace palpate
