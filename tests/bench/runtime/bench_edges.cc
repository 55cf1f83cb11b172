#include "tests/bench/runtime/bench_edges.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/response/tool_support.h"
#include "runtime/fast/potential_field.h"
#include "runtime/slow/memory_elements.h"
#include "tests/bench/runtime/edge_crossing.h"

namespace palpate {
namespace {

constexpr double kCrossingM = 1e-6;

using Eigen::Vector3d;

// The force at a place, found from an element; none where it is not over the two.
std::optional<Vector3d> force_at(const ElementCache& cache, int slot, FieldKind kind,
                                 double radius_m, const Vector3d& x) {
  FieldPlace place;
  adopt(place, cache, slot, x, kind);
  if (place.folded || place.outside) {
    return std::nullopt;
  }
  CurvePieces pieces;
  return respond(place, cache, radius_m, 0.0, pieces).force_n;
}

struct Steps {
  std::vector<double> step;
  std::vector<double> turn_rad;
};

void add_step(Steps& steps, const Vector3d& before, const Vector3d& after,
              const Vector3d& normal) {
  const Vector3d change = after - before;
  const double force = std::max(before.norm(), after.norm());
  if (force > 0.0) {
    steps.step.push_back((change - change.dot(normal) * normal).norm() / force);
    steps.turn_rad.push_back(std::atan2(before.cross(after).norm(), before.dot(after)));
  }
}

double at_share(std::vector<double>& sorted, double share) {
  if (sorted.empty()) {
    return 0.0;
  }
  return sorted[static_cast<std::size_t>(share *
                                         static_cast<double>(sorted.size() - 1))];
}

EdgesBenchRow row_of_steps(Steps& steps, LocalModel model, double depth_m) {
  std::sort(steps.step.begin(), steps.step.end());
  std::sort(steps.turn_rad.begin(), steps.turn_rad.end());
  return {.model = model,
          .depth_m = depth_m,
          .edges = static_cast<int>(steps.step.size()),
          .median = at_share(steps.step, 0.5),
          .p95 = at_share(steps.step, 0.95),
          .largest = at_share(steps.step, 1.0),
          .turn_p95_rad = at_share(steps.turn_rad, 0.95),
          .turn_largest_rad = at_share(steps.turn_rad, 1.0)};
}

}  // namespace

std::vector<EdgesBenchRow> run_edges_bench(const ResponseDatabase& database,
                                           const ResponseTable& table) {
  const ElementStream stream(database, table);
  const double radius_m = nominal_height_m(table.tool);
  const std::vector<EdgeCrossing> crossings = edge_crossings(database, table);
  const auto cache = std::make_unique<ElementCache>();
  std::vector<EdgesBenchRow> rows;
  for (const LocalModel model : {LocalModel::kFacets, LocalModel::kPotential}) {
    for (const double share : {0.2, 0.6, 1.0}) {
      const double depth_m = share * table.depth_max_m();
      Steps steps;
      for (const EdgeCrossing& at : crossings) {
        *cache = {};
        store(*cache, stream.element(at.triangle));
        store(*cache, stream.element(at.neighbour));
        const Vector3d x = at.middle_m + (radius_m - depth_m) * at.normal;
        const Vector3d half = 0.5 * kCrossingM * at.across;
        const int slot = find(*cache, at.triangle);
        const auto before =
            force_at(*cache, slot, field_kind(model), radius_m, x + half);
        const auto after =
            force_at(*cache, slot, field_kind(model), radius_m, x - half);
        if (before && after) {
          add_step(steps, *before, *after, at.normal);
        }
      }
      rows.push_back(row_of_steps(steps, model, depth_m));
    }
  }
  return rows;
}

std::string table_text(const std::vector<EdgesBenchRow>& rows) {
  std::string text = fmt::format("{:<10} {:>8} {:>6} {:>9} {:>9} {:>9} {:>11} {:>11}\n",
                                 "model", "depth mm", "edges", "median %", "p95 %",
                                 "largest %", "turn p95", "turn largest");
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  for (const EdgesBenchRow& row : rows) {
    text += fmt::format(
        "{:<10} {:>8.2f} {:>6} {:>9.4f} {:>9.4f} {:>9.4f} {:>7.3f} deg {:>8.3f} deg\n",
        name(row.model), 1e3 * row.depth_m, row.edges, 100.0 * row.median,
        100.0 * row.p95, 100.0 * row.largest, kDegrees * row.turn_p95_rad,
        kDegrees * row.turn_largest_rad);
  }
  return text;
}

std::string to_json(const std::vector<EdgesBenchRow>& rows) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const EdgesBenchRow& row : rows) {
    json.push_back({{"model", name(row.model)},
                    {"depth_m", row.depth_m},
                    {"edges", row.edges},
                    {"step_median", row.median},
                    {"step_p95", row.p95},
                    {"step_largest", row.largest},
                    {"turn_p95_rad", row.turn_p95_rad},
                    {"turn_largest_rad", row.turn_largest_rad}});
  }
  return json_text(nlohmann::ordered_json{{"rows", json}});
}

}  // namespace palpate
