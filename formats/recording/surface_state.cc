#include "formats/recording/surface_state.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/base/lines.h"
#include "formats/hdf5/hdf5_reader.h"

namespace palpate {
namespace {

constexpr const char* kSurfaceFormat = "palpate-surface";

// The state's columns, as a file has them.
struct Columns {
  std::vector<std::int32_t> site = {};
  std::vector<double> dent_m = {};
  std::vector<double> softened_m = {};
};

template <typename File, typename Values>
void exchange_columns(File& file, const std::string& tool, Values& columns) {
  const std::string group = "/tools/" + tool;
  file.group(group);
  file.dataset(group + "/site", "1", columns.site);
  file.dataset(group + "/dent_m", "m", columns.dent_m);
  file.dataset(group + "/softened_m", "m", columns.softened_m);
}

template <typename File, typename State>
void exchange_head(File& file, State& state) {
  file.attribute("/", "writer", state.writer);
  file.attribute("/", "database", state.database);
  file.attribute("/", "database_sha256", state.database_sha256);
}

std::vector<YieldedRow> rows_of_tool(const Hdf5Reader& file, const std::string& tool,
                                     const Columns& columns) {
  const std::size_t count = columns.site.size();
  if (columns.dent_m.size() != count || columns.softened_m.size() != count) {
    file.fail(
        fmt::format("/tools/{}: datasets have {}, {} and {} rows, must have as "
                    "many",
                    tool, count, columns.dent_m.size(), columns.softened_m.size()));
  }
  std::vector<YieldedRow> rows;
  for (std::size_t i = 0; i < count; ++i) {
    rows.push_back({columns.site[i], columns.dent_m[i], columns.softened_m[i]});
  }
  return rows;
}

}  // namespace

void write_surface_state(const std::filesystem::path& file, const SurfaceState& state) {
  const Hdf5Lock lock;
  AtomicFile atomic(file);
  Hdf5Writer out;
  out.attribute("/", "format", std::string(kSurfaceFormat));
  out.attribute("/", "format_version", kSurfaceStateVersion);
  exchange_head(out, state);
  std::vector<std::string> names;
  for (const auto& [tool, rows] : state.tool) {
    names.push_back(tool);
  }
  out.group("/tools");
  out.attribute("/tools", "names", join_lines(names));
  for (const auto& [tool, rows] : state.tool) {
    Columns columns;
    for (const YieldedRow& row : rows) {
      columns.site.push_back(row.site);
      columns.dent_m.push_back(row.dent_m);
      columns.softened_m.push_back(row.softened_m);
    }
    exchange_columns(out, tool, columns);
  }
  // The digest is of all before; as a remark it is not part of itself.
  out.remark("/", kDigestName, out.digest());
  atomic.write(out.image());
  atomic.commit();
}

SurfaceState read_surface_state(const std::filesystem::path& file) {
  const Hdf5Lock lock;
  Hdf5Reader in(file);
  if (!in.has_attribute("/", "format")) {
    in.fail("is not the state of a surface");
  }
  std::string format;
  std::int64_t version = 0;
  in.attribute("/", "format", format);
  if (format != kSurfaceFormat) {
    in.fail(fmt::format("attribute /@format is {:?}, must be {:?}",
                        format.substr(0, 80), kSurfaceFormat));
  }
  in.attribute("/", "format_version", version);
  if (version != kSurfaceStateVersion) {
    in.fail(
        fmt::format("format version is {}, must be {}", version, kSurfaceStateVersion));
  }
  SurfaceState state;
  exchange_head(in, state);
  std::string names;
  in.group("/tools");
  in.attribute("/tools", "names", names);
  for (const std::string& tool : split_lines(names)) {
    Columns columns;
    exchange_columns(in, tool, columns);
    state.tool[tool] = rows_of_tool(in, tool, columns);
    check_yielded(state.tool[tool], fmt::format("{}: /tools/{}", file.string(), tool));
  }
  if (in.remark("/", kDigestName) != in.digest()) {
    in.fail("is damaged: its SHA-256 is not the one it states");
  }
  return state;
}

SurfaceState read_surface_state(const std::filesystem::path& file,
                                const std::string& sha256,
                                const std::string& database) {
  SurfaceState state = read_surface_state(file);
  if (state.database_sha256 != sha256) {
    throw InputError(fmt::format(
        "{}: is the surface of another body, {} ({:.12}...), must be of {} ({:.12}...)",
        file.string(), state.database, state.database_sha256, database, sha256));
  }
  return state;
}

std::vector<YieldedRow> surface_of(const SurfaceState& surface,
                                   const std::vector<std::string>& tables) {
  std::vector<YieldedRow> rows;
  for (std::size_t table = 0; table < tables.size(); ++table) {
    const auto found = surface.tool.find(tables[table]);
    if (found == surface.tool.end()) {
      continue;
    }
    for (const YieldedRow& row : found->second) {
      rows.push_back(row);
      rows.back().table = static_cast<std::int32_t>(table);
    }
  }
  return rows;
}

void put_surface(const std::vector<YieldedRow>& rows,
                 const std::vector<std::string>& tables, SurfaceState& surface) {
  std::map<std::string, std::map<std::int32_t, YieldedRow>> deepest;
  for (const std::string& table : tables) {
    deepest[table];
  }
  for (const YieldedRow& row : rows) {
    const std::string& table = tables.at(static_cast<std::size_t>(row.table));
    YieldedRow& kept = deepest[table][row.site];
    kept.site = row.site;
    kept.dent_m = std::max(kept.dent_m, row.dent_m);
    kept.softened_m = std::max(kept.softened_m, row.softened_m);
  }
  for (const auto& [table, sites] : deepest) {
    std::vector<YieldedRow>& all = surface.tool[table];
    all.clear();
    for (const auto& [site, row] : sites) {
      all.push_back(row);
    }
  }
}

YieldedRow largest_of(const std::vector<YieldedRow>& rows) {
  YieldedRow largest;
  for (const YieldedRow& row : rows) {
    largest.dent_m = std::max(largest.dent_m, row.dent_m);
    largest.softened_m = std::max(largest.softened_m, row.softened_m);
  }
  return largest;
}

void check_yielded(const std::vector<YieldedRow>& rows, const std::string& where) {
  std::int32_t before = -1;
  std::int32_t table = 0;
  for (const YieldedRow& row : rows) {
    if (row.table < table) {
      throw FormatError(fmt::format("{}/table has {} after {}, must rise from 0 on",
                                    where, row.table, table));
    }
    // Sites rise within a table, and begin anew with the next.
    before = row.table > table ? -1 : before;
    table = row.table;
    if (row.site <= before) {
      throw FormatError(fmt::format("{}/site has {} after {}, must rise from 0 on",
                                    where, row.site, before));
    }
    before = row.site;
    for (const double depth_m : {row.dent_m, row.softened_m}) {
      if (!(depth_m >= 0.0) || !std::isfinite(depth_m)) {
        throw FormatError(
            fmt::format("{}: site {} has a depth of {} m, must be finite and not "
                        "negative",
                        where, row.site, depth_m));
      }
    }
  }
}

}  // namespace palpate
