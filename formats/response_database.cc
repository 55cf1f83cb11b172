#include "formats/response_database.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "formats/atomic_file.h"
#include "formats/error.h"
#include "formats/hdf5_io.h"

namespace palpate {
namespace {

constexpr const char* kFormatName = "palpate-response-database";
constexpr const char* kDigestName = "content_sha256";

// The content of a file, once for both directions: `File` is a Hdf5Writer and the rest
// constant, or a Hdf5Reader and the rest to be filled. The order is the digest's order.

template <typename File, typename Number>
void exchange_if_any(File& file, const std::string& group, const char* name,
                     Number& value) {
  if (file.optional_attribute(group, name, value != Number{})) {
    file.attribute(group, name, value);
  }
}

// A tool's axis, which not every tool has.
template <typename File, typename Axis>
void exchange_axis(File& file, const std::string& group, Axis& axis) {
  if (!file.optional_attribute(group, "axis_x", axis.has_value())) {
    return;
  }
  if constexpr (!File::kWrites) {
    axis.emplace();
  }
  constexpr std::array<const char*, 3> kNames{"axis_x", "axis_y", "axis_z"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    file.attribute(group, kNames[i], (*axis)[static_cast<Eigen::Index>(i)]);
  }
}

// What minor version 1 added: written only where it says something, so that a sphere
// has no more attributes than it had before.
template <typename File, typename Tool>
void exchange_shape(File& file, const std::string& group, Tool& tool) {
  exchange_if_any(file, group, "edge_radius_m", tool.edge_radius_m);
  exchange_if_any(file, group, "half_angle_rad", tool.half_angle_rad);
  exchange_if_any(file, group, "tip_radius_m", tool.tip_radius_m);
  exchange_if_any(file, group, "length_m", tool.length_m);
  exchange_axis(file, group, tool.axis);
  if (file.optional_attribute(group, "sticking", tool.sticking)) {
    std::int64_t sticking = 1;
    file.attribute(group, "sticking", sticking);
    if constexpr (!File::kWrites) {
      tool.sticking = sticking != 0;
    }
  }
  const std::string mesh = group + "/mesh";
  if (file.optional_group(mesh, tool.mesh.triangle.rows() > 0)) {
    file.dataset(mesh + "/position_m", "m", tool.mesh.position_m);
    file.dataset(mesh + "/triangle", "1", tool.mesh.triangle);
  }
}

template <typename File, typename Table>
void exchange_tool(File& file, const std::string& group, Table& table) {
  file.group(group);
  file.attribute(group, "shape", table.tool.kind);
  file.attribute(group, "radius_m", table.tool.radius_m);
  file.attribute(group, "friction", table.tool.friction);
  file.attribute(group, "presliding_m", table.tool.presliding_m);
  exchange_shape(file, group, table.tool);
  file.dataset(group + "/direction", "1", table.direction);
  file.dataset(group + "/direction_spread_rad", "rad", table.direction_spread_rad);
  file.dataset(group + "/touch_offset_m", "m", table.touch_offset_m);
  file.dataset(group + "/error_relative", "1", table.error_relative);
  file.dataset(group + "/friction", "1", table.friction);
  file.dataset(group + "/presliding_m", "m", table.presliding_m);
  file.dataset(group + "/stiffness_max_n_per_m", "N m-1", table.stiffness_max_n_per_m);
  file.dataset(group + "/origin", "1", table.origin);
  file.flags(group + "/origin", {0, 1, 2, 3}, "none simulated interpolated measured",
             false);
  file.dataset(group + "/flags", "1", table.flags);
  file.flags(group + "/flags",
             {kFallingCurve, kForceCapped, kCoarseContact, kErrorOverBudget, kFailed},
             "falling_curve force_capped coarse_contact error_over_budget failed",
             true);
  file.dataset(group + "/sample_begin", "1", table.sample_begin);
  file.dataset(group + "/depth_m", "m", table.depth_m);
  file.dataset(group + "/force_n", "N", table.force_n);
  file.dataset(group + "/stiffness_n_per_m", "N m-1", table.stiffness_n_per_m);
  file.dataset(group + "/energy_j", "J", table.energy_j);
}

template <typename File, typename Database>
void exchange_rest(File& file, Database& database) {
  file.group("/body");
  file.dataset("/body/position_m", "m", database.body.position_m);
  file.dataset("/body/triangle", "1", database.body.triangle);
  file.dataset("/body/normal", "1", database.normal);
  auto& measurement = database.measurement;
  if (file.optional_group("/measurement", !measurement.depth_m.empty())) {
    file.dataset("/measurement/depth_m", "m", measurement.depth_m);
    file.dataset("/measurement/force_n", "N", measurement.force_n);
  }
  auto& provenance = database.provenance;
  file.group("/provenance");
  file.attribute("/provenance", "source_file", provenance.source_file);
  file.attribute("/provenance", "source_sha256", provenance.source_sha256);
  file.attribute("/provenance", "left_out", provenance.left_out);
  file.text("/provenance/scene_toml", provenance.scene_toml);
}

// Tool names in the order of the database: groups themselves are not ordered.
std::string join_names(const std::vector<ResponseTable>& tools) {
  std::string names;
  for (const ResponseTable& table : tools) {
    names += (names.empty() ? "" : "\n") + table.tool.name;
  }
  return names;
}

std::vector<std::string> split_names(const std::string& names) {
  std::vector<std::string> list;
  for (std::size_t begin = 0; begin < names.size();) {
    const std::size_t end = std::min(names.find('\n', begin), names.size());
    list.push_back(names.substr(begin, end - begin));
    begin = end + 1;
  }
  return list;
}

void read_version(Hdf5Reader& file, const std::string& name) {
  std::string format;
  std::int64_t major = 0;
  std::int64_t minor = 0;
  if (!file.has_attribute("/", "format")) {
    throw FormatError(fmt::format(
        "{}: is an HDF5 file of another kind: attribute /@format is missing, must be "
        "\"{}\"",
        name, kFormatName));
  }
  file.attribute("/", "format", format);
  if (format != kFormatName) {
    throw FormatError(
        fmt::format("{}: is an HDF5 file of another kind: /@format is {:?}, must be "
                    "\"{}\"",
                    name, format.substr(0, 80), kFormatName));
  }
  file.attribute("/", "format_version", major);
  if (major != kDatabaseVersion) {
    throw FormatError(fmt::format("{}: has format version {}, this program reads {}{}",
                                  name, major, kDatabaseVersion,
                                  major > kDatabaseVersion ? "; use a newer one" : ""));
  }
  file.attribute("/", "format_version_minor", minor);
  if (minor < 0) {
    throw FormatError(fmt::format("{}: /@format_version_minor is {}, must be 0 or more",
                                  name, minor));
  }
}

}  // namespace

void write_database(const std::filesystem::path& file,
                    const ResponseDatabase& database) {
  check(database);
  AtomicFile atomic(file);
  Hdf5Writer out;
  out.attribute("/", "format", std::string(kFormatName));
  out.attribute("/", "format_version", std::int64_t{kDatabaseVersion});
  out.attribute("/", "format_version_minor", std::int64_t{kDatabaseVersionMinor});
  out.attribute("/", "writer", database.provenance.writer);
  exchange_rest(out, database);
  out.group("/tools");
  out.attribute("/tools", "names", join_names(database.tools));
  for (const ResponseTable& table : database.tools) {
    exchange_tool(out, "/tools/" + table.tool.name, table);
  }
  out.attribute("/", kDigestName, out.digest());
  atomic.write(out.image());
  atomic.commit();
}

ResponseDatabase read_database(const std::filesystem::path& file) {
  Hdf5Reader in(file);
  read_version(in, file.string());
  ResponseDatabase database;
  in.attribute("/", "writer", database.provenance.writer);
  exchange_rest(in, database);
  std::string names;
  in.group("/tools");
  in.attribute("/tools", "names", names);
  for (const std::string& name : split_names(names)) {
    ResponseTable& table = database.tools.emplace_back();
    table.tool.name = name;
    exchange_tool(in, "/tools/" + name, table);
  }
  const std::string computed = in.digest();
  std::string stored;
  in.attribute("/", kDigestName, stored);
  // What breaks a rule says more than a digest that differs, so the rules come first.
  try {
    check(database);
  } catch (const FormatError& error) {
    throw FormatError(fmt::format("{}: {}", file.string(), error.what()));
  }
  if (stored != computed) {
    throw FormatError(
        fmt::format("{}: content has SHA-256 {}, must be {:?} as /@{} says: the file "
                    "was damaged or changed",
                    file.string(), computed, stored.substr(0, 64), kDigestName));
  }
  return database;
}

const ResponseTable& find_tool(const ResponseDatabase& database,
                               const std::string& name) {
  std::string known;
  for (const ResponseTable& table : database.tools) {
    if (table.tool.name == name || (name.empty() && database.tools.size() == 1)) {
      return table;
    }
    known += (known.empty() ? "" : ", ") + table.tool.name;
  }
  throw InputError(name.empty()
                       ? fmt::format("a tool must be named; there are: {}", known)
                       : fmt::format("unknown tool {:?}; there are: {}", name, known));
}

}  // namespace palpate
