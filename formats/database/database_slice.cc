#include "formats/database/database_slice.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/database/database_diff.h"
#include "formats/database/select_nodes.h"
#include "formats/response/response_curve.h"

namespace palpate {
namespace {

// Depth inside (begin, end) at which the slope of the curve's cubic is extreme: cut
// there, what is left of a monotone cubic keeps its slopes within [0, 3 secant].
std::optional<double> slope_extreme_m(const CurveView& curve, std::size_t i,
                                      double end_m) {
  const double h = curve.depth_m[i + 1] - curve.depth_m[i];
  const double s = (curve.force_n[i + 1] - curve.force_n[i]) / h;
  const double m0 = curve.stiffness_n_per_m[i];
  const double m1 = curve.stiffness_n_per_m[i + 1];
  const double bend = m0 + m1 - 2.0 * s;
  const double t = -(3.0 * s - 2.0 * m0 - m1) / (3.0 * bend);
  const double depth_m = curve.depth_m[i] + t * h;
  if (bend != 0.0 && depth_m > curve.depth_m[i] && depth_m < end_m) {
    return depth_m;
  }
  return std::nullopt;
}

// Depths of a curve that is cut inside its interval i, and the place of each between
// the old samples for values that are not on the cubic.
std::vector<double> cut_depths(const CurveView& curve, double depth_m) {
  if (curve.depth_m.empty() || curve.depth_m.back() <= depth_m) {
    return {curve.depth_m.begin(), curve.depth_m.end()};
  }
  const auto after =
      std::lower_bound(curve.depth_m.begin(), curve.depth_m.end(), depth_m);
  std::vector<double> kept(curve.depth_m.begin(), after);
  if (const auto extreme = slope_extreme_m(curve, kept.size() - 1, depth_m)) {
    kept.push_back(*extreme);
  }
  kept.push_back(depth_m);
  return kept;
}

void append_cut(ResponseTable& table, const CurveView& curve,
                const std::vector<double>& depth_m) {
  for (std::size_t i = 0; i < depth_m.size(); ++i) {
    const bool stored = i < curve.depth_m.size() && curve.depth_m[i] == depth_m[i];
    const ResponseSample at = curve.at(depth_m[i]);
    table.depth_m.push_back(depth_m[i]);
    table.force_n.push_back(stored ? curve.force_n[i] : at.force_n);
    table.stiffness_n_per_m.push_back(stored ? curve.stiffness_n_per_m[i]
                                             : at.stiffness_n_per_m);
    table.energy_j.push_back(stored ? curve.energy_j[i] : at.energy_j);
  }
}

// Uncertainty and direction at the new samples: linear between the old ones.
void append_cut_extras(ResponseTable& cut_table, const ResponseTable& table,
                       std::int64_t node, const std::vector<double>& depth_m) {
  const CurveView curve = table.curve(node);
  const auto i = static_cast<std::size_t>(node);
  const bool turns = !table.direction_begin.empty() &&
                     table.direction_begin[i + 1] > table.direction_begin[i];
  for (const double depth : depth_m) {
    const auto above =
        std::lower_bound(curve.depth_m.begin(), curve.depth_m.end(), depth);
    // Interval k - 1 to k holds the depth; t is its part of the interval.
    const auto k = std::max<std::ptrdiff_t>(1, above - curve.depth_m.begin());
    const auto at = static_cast<std::size_t>(k);
    const double t =
        (depth - curve.depth_m[at - 1]) / (curve.depth_m[at] - curve.depth_m[at - 1]);
    if (!table.force_errors_n.empty()) {
      const auto sample = static_cast<std::size_t>(table.sample_begin[i]) + at;
      cut_table.force_errors_n.push_back((1.0 - t) * table.force_errors_n[sample - 1] +
                                         t * table.force_errors_n[sample]);
    }
    if (turns) {
      const Eigen::Index row = table.direction_begin[i] + k;
      // A blend of unit vectors is shorter than 1.
      const Eigen::RowVector3d u = (1.0 - t) * table.sample_direction.row(row - 1) +
                                   t * table.sample_direction.row(row);
      const Eigen::Index last = cut_table.sample_direction.rows();
      cut_table.sample_direction.conservativeResize(last + 1, 3);
      cut_table.sample_direction.row(last) = u.normalized();
    }
  }
}

void keep_tools(ResponseDatabase& database, const std::vector<std::string>& names) {
  if (names.empty()) {
    return;
  }
  std::vector<ResponseTable> kept;
  kept.reserve(names.size());
  for (const std::string& name : names) {
    kept.push_back(find_tool(database, name));
  }
  database.tools = std::move(kept);
}

ResponseDatabase keep_box(const ResponseDatabase& database,
                          const Eigen::AlignedBox3d& box_m) {
  const SurfaceMesh& body = database.body;
  std::vector<std::int32_t> triangles;
  std::vector<bool> used(static_cast<std::size_t>(body.position_m.rows()));
  for (Eigen::Index t = 0; t < body.triangle.rows(); ++t) {
    const auto corner = body.triangle.row(t);
    // A triangle stays if all its corners are in the box, a node if one of its
    // triangles does.
    if (std::all_of(corner.begin(), corner.end(), [&](std::int32_t node) {
          return box_m.contains(body.position_m.row(node).transpose());
        })) {
      triangles.push_back(static_cast<std::int32_t>(t));
      for (const std::int32_t node : corner) {
        used[static_cast<std::size_t>(node)] = true;
      }
    }
  }
  if (triangles.empty()) {
    throw InputError(
        fmt::format("no triangle lies in the box from ({}, {}, {}) to ({}, {}, {}) m",
                    box_m.min().x(), box_m.min().y(), box_m.min().z(), box_m.max().x(),
                    box_m.max().y(), box_m.max().z()));
  }
  std::vector<std::int32_t> nodes;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) {
      nodes.push_back(static_cast<std::int32_t>(i));
    }
  }
  return select_nodes(database, nodes, triangles);
}

void say(std::string& left_out, const std::string& what) {
  left_out += (left_out.empty() ? "" : "; ") + what;
}

}  // namespace

ResponseTable cut(const ResponseTable& table, double depth_m) {
  ResponseTable result = table;
  result.sample_begin = {0};
  for (auto* values : {&result.depth_m, &result.force_n, &result.stiffness_n_per_m,
                       &result.energy_j, &result.force_errors_n}) {
    values->clear();
  }
  result.sample_direction.resize(0, 3);
  result.direction_begin.assign(table.direction_begin.empty() ? 0 : 1, 0);
  for (std::int64_t i = 0; i < table.nodes(); ++i) {
    const std::vector<double> kept = cut_depths(table.curve(i), depth_m);
    append_cut(result, table.curve(i), kept);
    append_cut_extras(result, table, i, kept);
    result.sample_begin.push_back(static_cast<std::int64_t>(result.depth_m.size()));
    if (!table.direction_begin.empty()) {
      result.direction_begin.push_back(result.sample_direction.rows());
    }
    const auto node = static_cast<std::size_t>(i);
    const CurveView curve = result.curve(i);
    result.stiffness_max_n_per_m[node] = stiffness_max_n_per_m(curve);
    // A curve may have fallen beyond the cut alone.
    if (std::is_sorted(curve.force_n.begin(), curve.force_n.end())) {
      result.flags[node] =
          static_cast<std::uint8_t>(result.flags[node] & ~kFallingCurve);
    }
  }
  return result;
}

ResponseDatabase slice(const ResponseDatabase& database, const SliceOptions& options) {
  ResponseDatabase result = database;
  result.provenance.plan_sha256.clear();
  keep_tools(result, options.tools);
  if (options.box_m) {
    const Eigen::Index before = result.body.position_m.rows();
    result = keep_box(result, *options.box_m);
    say(result.provenance.left_out,
        fmt::format("slice: {} of {} nodes", before - result.body.position_m.rows(),
                    before));
  }
  if (options.depth_max_m) {
    if (!(*options.depth_max_m > 0.0)) {
      throw InputError(
          fmt::format("largest depth is {} m, must be positive", *options.depth_max_m));
    }
    for (ResponseTable& table : result.tools) {
      table = cut(table, *options.depth_max_m);
    }
    say(result.provenance.left_out,
        fmt::format("slice: depths beyond {} m", *options.depth_max_m));
  }
  return result;
}

ResponseDatabase merge(const std::vector<ResponseDatabase>& databases) {
  if (databases.empty()) {
    throw InputError("nothing to merge");
  }
  ResponseDatabase result = databases.front();
  if (databases.size() > 1) {
    result.provenance.plan_sha256.clear();
  }
  for (std::size_t i = 1; i < databases.size(); ++i) {
    const ResponseDatabase& other = databases[i];
    require_same_body(result, other);
    // Equal meshes may be of other materials: the source's digest shows it.
    if (other.provenance.source_sha256 != result.provenance.source_sha256) {
      throw InputError(fmt::format(
          "database {} comes from another source than the first: SHA-256 {:?}, must be "
          "{:?}",
          i, other.provenance.source_sha256, result.provenance.source_sha256));
    }
    for (const ResponseTable& table : other.tools) {
      const auto twin = std::find_if(result.tools.begin(), result.tools.end(),
                                     [&](const ResponseTable& known) {
                                       return known.tool.name == table.tool.name;
                                     });
      if (twin != result.tools.end()) {
        throw InputError(
            fmt::format("database {} has the tool {:?} once more", i, table.tool.name));
      }
      result.tools.push_back(table);
    }
    if (!other.measurement.depth_m.empty()) {
      if (!result.measurement.depth_m.empty()) {
        throw InputError(fmt::format(
            "database {} holds a measurement, and one before it does too", i));
      }
      result.measurement = other.measurement;
    }
  }
  return result;
}

}  // namespace palpate
