// The rules of FORMAT.md, applied to a database in memory.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/database/database_check_optional.h"
#include "formats/database/response_database.h"
#include "formats/response/response_curve.h"

namespace palpate {
namespace {

// A unit vector to this accuracy: rounding of a normalisation, with room for float32.
constexpr double kUnitTolerance = 1e-6;
// What rounding may leave between stored and recomputed slopes and energies.
constexpr double kRounding = 1e-9;

template <typename... Values>
[[noreturn]] void fail(fmt::format_string<Values...> what, Values&&... values) {
  throw FormatError(fmt::format(what, std::forward<Values>(values)...));
}

bool is_in(double value, double low, double high) {
  return value >= low && value <= high;
}

void check_body(const ResponseDatabase& database) {
  const SurfaceMesh& body = database.body;
  const Eigen::Index n = body.position_m.rows();
  if (n == 0 || body.triangle.rows() == 0) {
    fail("/body has {} nodes and {} triangles, must have some of both", n,
         body.triangle.rows());
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!body.position_m.row(i).allFinite()) {
      fail("/body/position_m: node {} is at ({}, {}, {}), must be finite", i,
           body.position_m(i, 0), body.position_m(i, 1), body.position_m(i, 2));
    }
  }
  for (Eigen::Index t = 0; t < body.triangle.rows(); ++t) {
    const auto node = body.triangle.row(t);
    if (node.minCoeff() < 0 || node.maxCoeff() >= n || node[0] == node[1] ||
        node[1] == node[2] || node[2] == node[0]) {
      fail(
          "/body/triangle: triangle {} is ({}, {}, {}), must be three different nodes "
          "in [0, {}]",
          t, node[0], node[1], node[2], n - 1);
    }
  }
  if (database.normal.rows() != n) {
    fail("/body/normal has {} rows, must have one per node: {}", database.normal.rows(),
         n);
  }
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

void check_sample_begin(const std::string& group, const ResponseTable& table) {
  const std::vector<std::int64_t>& begin = table.sample_begin;
  if (begin.front() != 0) {
    fail("{}/sample_begin: element 0 is {}, must be 0", group, begin.front());
  }
  for (std::size_t i = 0; i + 1 < begin.size(); ++i) {
    const std::int64_t count = begin[i + 1] - begin[i];
    if (begin[i + 1] < begin[i] || count == 1) {
      fail("{}/sample_begin: node {} owns samples {} to {}, must be none or 2 or more",
           group, i, begin[i], begin[i + 1]);
    }
  }
  if (begin.back() != static_cast<std::int64_t>(table.depth_m.size())) {
    fail("{}/sample_begin: the last element is {}, must be the number of samples {}",
         group, begin.back(), table.depth_m.size());
  }
}

void check_node_values(const std::string& group, const ResponseTable& table,
                       std::size_t i) {
  constexpr double kInfinity = std::numeric_limits<double>::max();
  const auto require = [&](const char* name, double value, double low, double high) {
    if (!is_in(value, low, high)) {
      fail("{}/{}: node {} has {}, must lie in [{:.6g}, {:.6g}]", group, name, i, value,
           low, high);
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
         i, table.presliding_m[i]);
  }
}

void check_direction(const std::string& group, const ResponseDatabase& database,
                     const ResponseTable& table, std::size_t node) {
  const auto i = static_cast<Eigen::Index>(node);
  const double direction = table.direction.row(i).norm();
  const double normal = database.normal.row(i).norm();
  const bool has_curve = table.sample_begin[node] != table.sample_begin[node + 1];
  // A node without a response may do without a vector: then it is exactly zero.
  const auto is_good = [&](double length) {
    return std::abs(length - 1.0) <= kUnitTolerance || (length == 0.0 && !has_curve);
  };
  if (!is_good(direction)) {
    fail("{}/direction: node {} has length {}, must be 1", group, node, direction);
  }
  if (!is_good(normal)) {
    fail("/body/normal: node {} has length {}, must be 1", node, normal);
  }
}

void check_samples(const std::string& group, const CurveView& curve, std::size_t node) {
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
void check_slopes(const std::string& group, const CurveView& curve, std::size_t node) {
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

void check_energy(const std::string& group, const CurveView& curve, std::size_t node) {
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

void check_curve(const std::string& group, const ResponseTable& table,
                 std::size_t node) {
  const CurveView curve = table.curve(static_cast<std::int64_t>(node));
  const bool has_curve = !curve.depth_m.empty();
  const bool has_origin =
      table.origin[node] != static_cast<std::uint8_t>(ResponseOrigin::kNone);
  if (has_curve != has_origin) {
    fail("{}/origin: node {} is {} but has {} samples, must be 0 without samples only",
         group, node, table.origin[node], curve.depth_m.size());
  }
  if (has_curve) {
    check_samples(group, curve, node);
    check_slopes(group, curve, node);
    check_energy(group, curve, node);
  }
  const bool falls = !std::is_sorted(curve.force_n.begin(), curve.force_n.end());
  const bool flagged = (table.flags[node] & kFallingCurve) != 0;
  if (falls != flagged) {
    fail("{}/flags: node {} is {}flagged as falling, but its force {}", group, node,
         flagged ? "" : "not ", falls ? "falls with depth" : "never falls");
  }
  const double largest = stiffness_max_n_per_m(curve);
  if (!(std::abs(table.stiffness_max_n_per_m[node] - largest) <= kRounding * largest)) {
    fail(
        "{}/stiffness_max_n_per_m: node {} has {}, must be the curve's largest slope "
        "{}",
        group, node, table.stiffness_max_n_per_m[node], largest);
  }
}

void check_tool(const ResponseDatabase& database, const ResponseTable& table) {
  try {
    check(table.tool);
  } catch (const InputError& error) {
    fail("/tools: {}", error.what());
  }
  const std::string group = "/tools/" + table.tool.name;
  const auto n = static_cast<std::size_t>(database.body.position_m.rows());
  check_sizes(group, table, n);
  check_sample_begin(group, table);
  for (std::size_t i = 0; i < n; ++i) {
    check_node_values(group, table, i);
    check_direction(group, database, table, i);
    check_curve(group, table, i);
  }
  check_optional(group, table);
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
  for (const std::string* text :
       {&provenance.writer, &provenance.source_file, &provenance.left_out}) {
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

void check(const ResponseDatabase& database) {
  check_body(database);
  if (database.tools.empty()) {
    fail("/tools is empty, must hold at least one tool");
  }
  std::set<std::string> names;
  for (const ResponseTable& table : database.tools) {
    check_tool(database, table);
    if (!names.insert(table.tool.name).second) {
      fail("/tools: the name {:?} occurs twice, must be unique", table.tool.name);
    }
  }
  check(database.measurement, database.body.position_m.rows());
  check_provenance(database.provenance);
}

}  // namespace palpate
