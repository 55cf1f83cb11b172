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

namespace palpate {
namespace {

constexpr double kCrossingM = 1e-6;

using Eigen::Vector3d;

Vector3d values_of(const std::array<double, 3>& values) {
  return Eigen::Map<const Vector3d>(values.data());
}

bool responds(const Element& element) {
  return std::all_of(element.node.begin(), element.node.end(),
                     [](const ElementNode& node) {
                       return node.samples > 0;
                     });
}

// Over the middle of the edge from node j to the next.
struct Crossing {
  Vector3d middle_m;
  Vector3d normal;
  Vector3d across;
};

Crossing crossing_of(const Element& element, std::size_t j) {
  const ElementNode& a = element.node[j];
  const ElementNode& b = element.node[(j + 1) % 3];
  const Vector3d normal = (values_of(a.normal) + values_of(b.normal)).normalized();
  const Vector3d edge = values_of(b.position_m) - values_of(a.position_m);
  return {0.5 * (values_of(a.position_m) + values_of(b.position_m)), normal,
          normal.cross(edge).normalized()};
}

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

// All elements of a body, each pair of neighbours once.
template <typename Take>
void each_edge(const ElementStream& stream, std::int32_t triangles, const Take& take) {
  for (std::int32_t t = 0; t < triangles; ++t) {
    const Element element = stream.element(t);
    for (std::size_t j = 0; j < 3 && responds(element); ++j) {
      const std::int32_t next = element.neighbour[j];
      if (next > t) {
        const Element other = stream.element(next);
        if (responds(other)) {
          take(element, other, j);
        }
      }
    }
  }
}

}  // namespace

std::vector<EdgesBenchRow> run_edges_bench(const ResponseDatabase& database,
                                           const ResponseTable& table) {
  const ElementStream stream(database, table);
  const double radius_m = nominal_height_m(table.tool);
  const auto triangles = static_cast<std::int32_t>(database.body.triangle.rows());
  const auto cache = std::make_unique<ElementCache>();
  std::vector<EdgesBenchRow> rows;
  for (const LocalModel model : {LocalModel::kFacets, LocalModel::kPotential}) {
    for (const double share : {0.2, 0.6, 1.0}) {
      const double depth_m = share * table.depth_max_m();
      Steps steps;
      each_edge(stream, triangles,
                [&](const Element& one, const Element& other, std::size_t j) {
                  *cache = {};
                  store(*cache, one);
                  store(*cache, other);
                  const Crossing at = crossing_of(one, j);
                  const Vector3d x = at.middle_m + (radius_m - depth_m) * at.normal;
                  const Vector3d half = 0.5 * kCrossingM * at.across;
                  const int slot = find(*cache, one.triangle);
                  const auto before =
                      force_at(*cache, slot, field_kind(model), radius_m, x + half);
                  const auto after =
                      force_at(*cache, slot, field_kind(model), radius_m, x - half);
                  if (before && after) {
                    add_step(steps, *before, *after, at.normal);
                  }
                });
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
