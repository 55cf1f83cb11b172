#include "formats/database/database_rules.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "formats/database/compliance_rules.h"
#include "formats/database/database_check_optional.h"
#include "formats/database/format_error.h"
#include "formats/database/tilt_rules.h"
#include "formats/response/response_curve.h"

namespace palpate {
namespace {

// What rounding may leave between stored and recomputed slopes and energies.
constexpr double kRounding = 1e-9;

bool is_in(double value, double low, double high) {
  return value >= low && value <= high;
}

// A node as the file counts it.
std::int64_t node_in_file(std::size_t row, std::int64_t first) {
  return first + static_cast<std::int64_t>(row);
}

// Every per-node array of a tool has one entry per node.
void check_sizes(const std::string& group, const ResponseTable& table, std::size_t n) {
  const auto require = [&](const char* name, std::size_t size, std::size_t wanted) {
    if (size != wanted) {
      fail("{}/{} has {} rows, must have {}", group, name, size, wanted);
    }
  };
  require("direction", static_cast<std::size_t>(table.direction.rows()), n);
  require("direction_spread_rad", table.direction_spread_rad.size(), n);
  require("touch_offset_m", table.touch_offset_m.size(), n);
  require("error_relative", table.error_relative.size(), n);
  require("friction", table.friction.size(), n);
  require("presliding_m", table.presliding_m.size(), n);
  require("stiffness_max_n_per_m", table.stiffness_max_n_per_m.size(), n);
  require("origin", table.origin.size(), n);
  require("flags", table.flags.size(), n);
  require("sample_begin", table.sample_begin.size(), n + 1);
  const std::size_t samples = table.depth_m.size();
  require("force_n", table.force_n.size(), samples);
  require("stiffness_n_per_m", table.stiffness_n_per_m.size(), samples);
  require("energy_j", table.energy_j.size(), samples);
}

void check_sample_begin(const std::string& group, const ResponseTable& table,
                        std::int64_t first) {
  const std::vector<std::int64_t>& begin = table.sample_begin;
  if (begin.front() != 0) {
    fail("{}/sample_begin: element 0 is {}, must be 0", group, begin.front());
  }
  for (std::size_t i = 0; i + 1 < begin.size(); ++i) {
    const std::int64_t count = begin[i + 1] - begin[i];
    if (begin[i + 1] < begin[i] || count == 1) {
      fail("{}/sample_begin: node {} owns samples {} to {}, must be none or 2 or more",
           group, node_in_file(i, first), begin[i], begin[i + 1]);
    }
  }
  if (begin.back() != static_cast<std::int64_t>(table.depth_m.size())) {
    fail("{}/sample_begin: the last element is {}, must be the number of samples {}",
         group, begin.back(), table.depth_m.size());
  }
}

void check_node_values(const std::string& group, const ResponseTable& table,
                       std::size_t i, std::int64_t first) {
  constexpr double kInfinity = std::numeric_limits<double>::max();
  const auto require = [&](const char* name, double value, double low, double high) {
    if (!is_in(value, low, high)) {
      fail("{}/{}: node {} has {}, must lie in [{:.6g}, {:.6g}]", group, name,
           node_in_file(i, first), value, low, high);
    }
  };
  require("direction_spread_rad", table.direction_spread_rad[i], 0.0, std::numbers::pi);
  require("touch_offset_m", table.touch_offset_m[i], -kInfinity, kInfinity);
  require("error_relative", table.error_relative[i], 0.0, kInfinity);
  require("friction", table.friction[i], 0.0, 10.0);
  require("presliding_m", table.presliding_m[i], 0.0, kInfinity);
  require("origin", table.origin[i], 0.0, 3.0);
  require("flags", table.flags[i], 0.0, kAllResponseFlags);
  if (table.friction[i] > 0.0 && !(table.presliding_m[i] > 0.0)) {
    fail("{}/presliding_m: node {} has {}, must be positive where friction is", group,
         node_in_file(i, first), table.presliding_m[i]);
  }
}

// A node without a response may do without a vector: then it is exactly zero.
bool is_direction(double length, bool has_curve) {
  return std::abs(length - 1.0) <= kUnitTolerance || (length == 0.0 && !has_curve);
}

bool has_curve(const ResponseTable& table, std::size_t node) {
  return table.sample_begin[node] != table.sample_begin[node + 1];
}

void check_direction(const std::string& group, const ResponseTable& table,
                     std::size_t node, std::int64_t first) {
  const double length = table.direction.row(static_cast<Eigen::Index>(node)).norm();
  if (!is_direction(length, has_curve(table, node))) {
    fail("{}/direction: node {} has length {}, must be 1", group,
         node_in_file(node, first), length);
  }
}

void check_samples(const std::string& group, const CurveView& curve,
                   std::int64_t node) {
  const std::size_t n = curve.depth_m.size();
  if (curve.depth_m[0] != 0.0 || curve.force_n[0] != 0.0 || curve.energy_j[0] != 0.0) {
    fail("{}: the curve of node {} starts at ({} m, {} N, {} J), must start at zero",
         group, node, curve.depth_m[0], curve.force_n[0], curve.energy_j[0]);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto require = [&](const char* name, double value, bool good,
                             const char* what) {
      if (!good || !std::isfinite(value)) {
        fail("{}/{}: node {} sample {} is {}, must be {}", group, name, node, i, value,
             what);
      }
    };
    require("depth_m", curve.depth_m[i],
            i == 0 || curve.depth_m[i] > curve.depth_m[i - 1],
            "finite and larger than the one before");
    require("force_n", curve.force_n[i], curve.force_n[i] >= 0.0,
            "finite and not negative");
    require("stiffness_n_per_m", curve.stiffness_n_per_m[i], true, "finite");
    require("energy_j", curve.energy_j[i], true, "finite");
  }
}

// The cubic of an interval stays between its ends when both slopes lie in [0, 3 secant]
// (Fritsch & Carlson 1980).
void check_slopes(const std::string& group, const CurveView& curve, std::int64_t node) {
  for (std::size_t i = 0; i + 1 < curve.depth_m.size(); ++i) {
    const double secant = (curve.force_n[i + 1] - curve.force_n[i]) /
                          (curve.depth_m[i + 1] - curve.depth_m[i]);
    const double low = std::min(0.0, 3.0 * secant) * (1.0 + kRounding);
    const double high = std::max(0.0, 3.0 * secant) * (1.0 + kRounding);
    for (const std::size_t end : {i, i + 1}) {
      if (!is_in(curve.stiffness_n_per_m[end], low, high)) {
        fail(
            "{}/stiffness_n_per_m: node {} sample {} is {} N/m, overshoots: must lie "
            "in [{}, {}]",
            group, node, end, curve.stiffness_n_per_m[end], low, high);
      }
    }
  }
}

void check_energy(const std::string& group, const CurveView& curve, std::int64_t node) {
  double energy = 0.0;
  double scale = 0.0;
  for (std::size_t i = 0; i + 1 < curve.depth_m.size(); ++i) {
    energy += interval_energy_j(curve, i);
    scale = std::max(scale, std::abs(energy));
    if (!(std::abs(curve.energy_j[i + 1] - energy) <= kRounding * scale)) {
      fail("{}/energy_j: node {} sample {} is {} J, must be the integral of force {} J",
           group, node, i + 1, curve.energy_j[i + 1], energy);
    }
  }
}

void check_curve(const std::string& group, const ResponseTable& table, std::size_t row,
                 std::int64_t first) {
  const std::int64_t node = node_in_file(row, first);
  const CurveView curve = table.curve(static_cast<std::int64_t>(row));
  const bool has_origin =
      table.origin[row] != static_cast<std::uint8_t>(ResponseOrigin::kNone);
  if (has_curve(table, row) != has_origin) {
    fail("{}/origin: node {} is {} but has {} samples, must be 0 without samples only",
         group, node, table.origin[row], curve.depth_m.size());
  }
  if (has_curve(table, row)) {
    check_samples(group, curve, node);
    check_slopes(group, curve, node);
    check_energy(group, curve, node);
  }
  // Flags and the largest slope follow from the samples. A reader that trusts them must
  // not be misled.
  const bool falls = !std::is_sorted(curve.force_n.begin(), curve.force_n.end());
  const bool flagged = (table.flags[row] & kFallingCurve) != 0;
  if (falls != flagged) {
    fail("{}/flags: node {} is {}flagged as falling, but its force {}", group, node,
         flagged ? "" : "not ", falls ? "falls with depth" : "never falls");
  }
  const double largest = stiffness_max_n_per_m(curve);
  if (!(std::abs(table.stiffness_max_n_per_m[row] - largest) <= kRounding * largest)) {
    fail(
        "{}/stiffness_max_n_per_m: node {} has {}, must be the curve's largest slope "
        "{}",
        group, node, table.stiffness_max_n_per_m[row], largest);
  }
}

// Marks what a chunk names; each may be named once.
void mark(const char* path, const std::vector<std::int32_t>& names,
          std::vector<bool>& seen) {
  for (const std::int32_t name : names) {
    if (name < 0 || static_cast<std::size_t>(name) >= seen.size()) {
      fail("{} holds {}, must lie in [0, {}]", path, name, seen.size() - 1);
    }
    if (seen[static_cast<std::size_t>(name)]) {
      fail("{} holds {} twice, must hold each once", path, name);
    }
    seen[static_cast<std::size_t>(name)] = true;
  }
}

void check_provenance(const Provenance& provenance) {
  const std::string& digest = provenance.source_sha256;
  const auto is_digit = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
  };
  if (!digest.empty() &&
      (digest.size() != 64 || !std::all_of(digest.begin(), digest.end(), is_digit))) {
    fail("/provenance@source_sha256 is {:?}, must be empty or 64 hexadecimal digits",
         digest.substr(0, 80));
  }
  // Attributes live in object headers, which hold 64 KiB.
  constexpr std::size_t kLongest = 16384;
  for (const std::string* text : {&provenance.writer, &provenance.source_file,
                                  &provenance.left_out, &provenance.plan_sha256}) {
    if (text->size() > kLongest || text->find('\0') != std::string::npos) {
      fail("/provenance holds a text of {} bytes, must be at most {} without NUL",
           text->size(), kLongest);
    }
  }
  if (provenance.scene_toml.find('\0') != std::string::npos) {
    fail("/provenance/scene_toml holds a NUL byte, must be text");
  }
}

}  // namespace

void check_nodes(const Points& position_m, const Points& normal, std::int64_t first) {
  const auto n = static_cast<std::size_t>(position_m.rows());
  if (normal.rows() != position_m.rows()) {
    fail("/body/normal has {} rows, must have one per node: {}", normal.rows(), n);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d at = position_m.row(static_cast<Eigen::Index>(i));
    const double length = normal.row(static_cast<Eigen::Index>(i)).norm();
    if (!at.allFinite()) {
      fail("/body/position_m: node {} is at ({}, {}, {}), must be finite",
           node_in_file(i, first), at.x(), at.y(), at.z());
    }
    if (!is_direction(length, false)) {
      fail("/body/normal: node {} has length {}, must be 1", node_in_file(i, first),
           length);
    }
  }
}

void check_triangles(const Triangles& triangle, std::int64_t nodes,
                     std::int64_t first) {
  for (Eigen::Index t = 0; t < triangle.rows(); ++t) {
    const auto node = triangle.row(t);
    if (node.minCoeff() < 0 || node.maxCoeff() >= nodes || node[0] == node[1] ||
        node[1] == node[2] || node[2] == node[0]) {
      fail(
          "/body/triangle: triangle {} is ({}, {}, {}), must be three different nodes "
          "in [0, {}]",
          first + t, node[0], node[1], node[2], nodes - 1);
    }
  }
}

void check_responses(const std::string& group, const ResponseTable& table,
                     std::int64_t first) {
  try {
    check(table.tool);
  } catch (const InputError& error) {
    fail("/tools: {}", error.what());
  }
  const auto n = static_cast<std::size_t>(table.nodes());
  check_sizes(group, table, n);
  check_sample_begin(group, table, first);
  for (std::size_t i = 0; i < n; ++i) {
    check_node_values(group, table, i, first);
    check_direction(group, table, i, first);
    check_curve(group, table, i, first);
  }
}

void check_normals(const Points& normal, const ResponseTable& table, std::int64_t first,
                   std::span<const double> longest_edge_m) {
  for (Eigen::Index i = 0; i < normal.rows(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    if (const double length = normal.row(i).norm();
        !is_direction(length, has_curve(table, row))) {
      fail("/body/normal: node {} has length {}, must be 1", node_in_file(row, first),
           length);
    }
  }
  check_tilts(normal, table, first, longest_edge_m);
}

void check_chunk(const DatabaseIndex& index, std::int64_t chunk,
                 const BodyChunk& body) {
  for (Eigen::Index i = 0; i < body.position_m.rows(); ++i) {
    const auto at = body.position_m.row(i).array();
    if ((at < index.box_min_m.row(chunk).array()).any() ||
        (at > index.box_max_m.row(chunk).array()).any()) {
      fail("/body/position_m: node {} lies outside of the box of chunk {}",
           body.node_begin + i, chunk);
    }
  }
  const std::int64_t end = body.node_begin + body.position_m.rows();
  for (Eigen::Index t = 0; t < body.triangle.rows(); ++t) {
    const std::int32_t least = body.triangle.row(t).minCoeff();
    if (least < body.node_begin || least >= end) {
      fail(
          "/body/triangle: chunk {} holds ({}, {}, {}), whose first node must be its "
          "own",
          chunk, body.triangle(t, 0), body.triangle(t, 1), body.triangle(t, 2));
    }
  }
}

SourceNames::SourceNames(const DatabaseIndex& index)
    : chunk_(static_cast<std::size_t>(index.chunks())),
      node_(static_cast<std::size_t>(index.nodes())),
      triangle_(static_cast<std::size_t>(index.triangles())) {}

void SourceNames::add(std::int64_t chunk, const BodyChunk& body) {
  const auto k = static_cast<std::size_t>(chunk);
  if (!chunk_[k]) {
    mark("/body/source_node", body.source_node, node_);
    mark("/body/source_triangle", body.source_triangle, triangle_);
    chunk_[k] = true;
  }
}

void check_chunk(const ToolIndex& index, std::int64_t chunk,
                 const ResponseTable& table) {
  const auto k = static_cast<std::size_t>(chunk);
  const TableMaxima found = maxima_of(table, 0, table.nodes());
  const auto require = [&](const char* name, double stated, double value) {
    if (stated != value) {
      fail("/tools/{}/index/{}: chunk {} has {}, must be the largest of its nodes, {}",
           index.tool.name, name, chunk, stated, value);
    }
  };
  require("depth_max_m", index.depth_max_m[k], found.depth_m);
  require("force_max_n", index.force_max_n[k], found.force_n);
  require("stiffness_max_n_per_m", index.stiffness_max_n_per_m[k],
          found.stiffness_n_per_m);
  require("error_relative_max", index.error_relative_max[k], found.error_relative);
  require("direction_spread_max_rad", index.direction_spread_max_rad[k],
          found.direction_spread_rad);
}

void check(const ResponseDatabase& database) {
  const SurfaceMesh& body = database.body;
  const Eigen::Index n = body.position_m.rows();
  if (n == 0 || body.triangle.rows() == 0) {
    fail("/body has {} nodes and {} triangles, must have some of both", n,
         body.triangle.rows());
  }
  check_nodes(body.position_m, database.normal);
  check_triangles(body.triangle, n);
  if (database.tools.empty()) {
    fail("/tools is empty, must hold at least one tool");
  }
  const std::vector<double> longest_edge_m = longest_edges_m(body);
  std::set<std::string> names;
  for (const ResponseTable& table : database.tools) {
    const std::string group = "/tools/" + table.tool.name;
    if (table.nodes() != n) {
      fail("{} has {} nodes, must have {}", group, table.nodes(), n);
    }
    check_responses(group, table);
    check_normals(database.normal, table, 0, longest_edge_m);
    check_optional(group, table);
    if (!names.insert(table.tool.name).second) {
      fail("/tools: the name {:?} occurs twice, must be unique", table.tool.name);
    }
  }
  check_contact_tables(database.tools);
  check(database.measurement, n);
  check_provenance(database.provenance);
}

}  // namespace palpate
