#include "runtime/hand/press_site.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"

namespace palpate {
namespace {

bool has_response(const ResponseTable& table, Eigen::Index node) {
  return !table.curve(node).depth_m.empty();
}

// Edges from each node to the nearest node without response; -1: there is none.
std::vector<int> edges_to_rim(const ResponseDatabase& database,
                              const ResponseTable& table) {
  const Eigen::Index n = database.body.position_m.rows();
  const auto neighbour = vertex_neighbours(n, database.body.triangle);
  std::vector<int> edges(static_cast<std::size_t>(n), -1);
  std::vector<std::int32_t> front;
  for (std::int32_t v = 0; v < n; ++v) {
    if (!has_response(table, v)) {
      edges[static_cast<std::size_t>(v)] = 0;
      front.push_back(v);
    }
  }
  for (std::size_t i = 0; i < front.size(); ++i) {  // breadth first; grows as it goes
    const auto from = static_cast<std::size_t>(front[i]);
    for (const std::int32_t v : neighbour[from]) {
      if (edges[static_cast<std::size_t>(v)] < 0) {
        edges[static_cast<std::size_t>(v)] = edges[from] + 1;
        front.push_back(v);
      }
    }
  }
  return edges;
}

// Largest depth on the curve, up to `depth_m`, with at most that force.
double depth_within(const CurveView& curve, double depth_m, double force_n) {
  constexpr int kSteps = 200;
  double within = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    const double d = depth_m * i / kSteps;
    if (curve.at(d).force_n > force_n) {
      break;
    }
    within = d;
  }
  return within;
}

// A needle is inserted in two goes, past the beginning of the last layer below the node
// by what its curve has computed, with a rest between them, and withdrawn.
void insert(HandScript& script, const Puncture& puncture, std::int32_t node,
            double depth_max_m) {
  constexpr double kFirstGo = 0.6;
  script.deeper_m = last_layer_m(puncture, node) + depth_max_m;
  script.press_m = kFirstGo * script.deeper_m;
  script.circle_m = 0.0;
}

}  // namespace

std::int32_t node_to_press(const ResponseDatabase& database, const ResponseTable& table,
                           const std::optional<Eigen::Vector3d>& at_m) {
  const Points& position = database.body.position_m;
  const std::vector<int> edges =
      at_m ? std::vector<int>{} : edges_to_rim(database, table);
  std::int32_t best = -1;
  double best_score = -std::numeric_limits<double>::infinity();
  double best_height = best_score;
  for (std::int32_t v = 0; v < position.rows(); ++v) {
    if (!has_response(table, v)) {
      continue;
    }
    // Nearest to the wanted place; without one, most edges away from the rim of the
    // responses. The higher node decides between equals.
    const double score = at_m ? -(position.row(v).transpose() - *at_m).norm()
                              : static_cast<double>(edges[static_cast<std::size_t>(v)]);
    const double height = position(v, 2);
    if (score > best_score || (score == best_score && height > best_height)) {
      best = v;
      best_score = score;
      best_height = height;
    }
  }
  if (best < 0) {
    throw InputError(fmt::format("tool \"{}\": no node of the body has a response",
                                 table.tool.name));
  }
  return best;
}

HandScript script_at(const ResponseDatabase& database, const ResponseTable& table,
                     std::int32_t node, double force_max_n, double force_scale,
                     double hand_n_per_m) {
  constexpr double kFirst = 0.3;  // of the curve's depth
  constexpr double kForceShare = 0.4;
  const CurveView curve = table.curve(node);
  const double along =
      std::abs(database.normal.row(node).dot(table.direction.row(node)));
  const auto hand_depth_m = [&](int press) {
    const double d = depth_within(curve, press * kFirst * curve.depth_max_m(),
                                  press * kForceShare * force_max_n / force_scale);
    const double force_n = curve.at(d).force_n * force_scale;
    return table.touch_offset_m[static_cast<std::size_t>(node)] +
           d / std::max(along, 0.1) + force_n / hand_n_per_m;
  };
  HandScript script;
  script.surface_m = database.body.position_m.row(node).transpose();
  script.normal = database.normal.row(node).transpose();
  script.touch_m = height_at_touch_m(table.tool, script.normal);
  script.clear_m = std::max(0.005, curve.depth_max_m());
  script.press_m = hand_depth_m(1);
  script.deeper_m = hand_depth_m(2);
  const double smallest_side = bounding_box(database.body).sizes().minCoeff();
  script.circle_m = 1.5 * mean_edge_m(database.body);
  if (smallest_side > 0.0) {
    script.circle_m = std::min(script.circle_m, 0.05 * smallest_side);
  }
  if (!table.puncture.empty()) {
    insert(script, table.puncture, node, curve.depth_max_m());
  }
  return script;
}

}  // namespace palpate
