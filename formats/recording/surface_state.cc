#include "formats/recording/surface_state.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/base/lines.h"
#include "formats/base/utf8_path.h"
#include "formats/forms/open_stored.h"

namespace palpate {
namespace {

constexpr const char* kSurfaceFormat = "palpate-surface";

// The state's columns, as a file has them.
struct Columns {
  std::vector<std::int32_t> site = {};
  std::vector<double> dent_m = {};
  std::vector<double> softened_m = {};
};

struct ChannelColumns {
  RowMajor<double> entry_m = {};
  RowMajor<double> axis = {};
  std::vector<double> depth_m = {};
  std::vector<std::int32_t> layer = {};
  RowMajor<double> layer_depth_m = {};
  RowMajor<std::int32_t> layer_material = {};
};

template <typename File, typename Values>
void exchange_columns(File& file, const std::string& tool, Values& columns) {
  const std::string group = "/tools/" + tool;
  file.group(group);
  file.dataset(group + "/site", "1", columns.site);
  file.dataset(group + "/dent_m", "m", columns.dent_m);
  file.dataset(group + "/softened_m", "m", columns.softened_m);
}

std::string channel_group(const std::string& tool) {
  return "/tools/" + tool + "/channel";
}

template <typename File, typename Values>
void exchange_channels(File& file, const std::string& tool, Values& columns) {
  const std::string group = channel_group(tool);
  file.group(group);
  file.dataset(group + "/entry_m", "m", columns.entry_m);
  file.dataset(group + "/axis", "1", columns.axis);
  file.dataset(group + "/depth_m", "m", columns.depth_m);
  file.dataset(group + "/layer", "1", columns.layer);
  file.dataset(group + "/layer_depth_m", "m", columns.layer_depth_m);
  file.dataset(group + "/layer_material", "1", columns.layer_material);
}

template <typename File, typename State>
void exchange_head(File& file, State& state) {
  file.attribute("/", "writer", state.writer);
  file.attribute("/", "database", state.database);
  file.attribute("/", "database_sha256", state.database_sha256);
}

std::vector<YieldedRow> rows_of_tool(const StoredReader& file, const std::string& tool,
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

Columns columns_of(const std::vector<YieldedRow>& rows) {
  Columns columns;
  for (const YieldedRow& row : rows) {
    columns.site.push_back(row.site);
    columns.dent_m.push_back(row.dent_m);
    columns.softened_m.push_back(row.softened_m);
  }
  return columns;
}

template <typename T, std::size_t kWidth>
void put_row(const std::array<T, kWidth>& from, Eigen::Index i, RowMajor<T>& to) {
  to.row(i) = Eigen::Map<const Eigen::Matrix<T, 1, Eigen::Dynamic>>(
      from.data(), 1, static_cast<Eigen::Index>(kWidth));
}

template <typename T, std::size_t kWidth>
void get_row(const RowMajor<T>& from, Eigen::Index i, std::array<T, kWidth>& to) {
  Eigen::Map<Eigen::Matrix<T, 1, Eigen::Dynamic>>(
      to.data(), 1, static_cast<Eigen::Index>(kWidth)) = from.row(i);
}

ChannelColumns columns_of(const std::vector<ChannelRow>& rows) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  ChannelColumns columns;
  columns.entry_m.resize(count, 3);
  columns.axis.resize(count, 3);
  columns.layer_depth_m.resize(count, kKeptLayers);
  columns.layer_material.resize(count, kKeptLayers);
  for (Eigen::Index i = 0; i < count; ++i) {
    const ChannelRow& row = rows[static_cast<std::size_t>(i)];
    put_row(row.entry_m, i, columns.entry_m);
    put_row(row.axis, i, columns.axis);
    columns.depth_m.push_back(row.depth_m);
    columns.layer.push_back(row.layer);
    put_row(row.layer_depth_m, i, columns.layer_depth_m);
    put_row(row.layer_material, i, columns.layer_material);
  }
  return columns;
}

std::vector<ChannelRow> channels_of(const StoredReader& file, const std::string& tool,
                                    const ChannelColumns& columns) {
  const auto count = static_cast<Eigen::Index>(columns.depth_m.size());
  const auto is = [&](const auto& rows, Eigen::Index width) {
    return rows.rows() == count && (rows.cols() == width || count == 0);
  };
  if (static_cast<Eigen::Index>(columns.layer.size()) != count ||
      !is(columns.entry_m, 3) || !is(columns.axis, 3) ||
      !is(columns.layer_depth_m, kKeptLayers) ||
      !is(columns.layer_material, kKeptLayers)) {
    file.fail(
        fmt::format("{}: datasets differ in their number of rows, or have no 3 "
                    "or {} columns",
                    channel_group(tool), kKeptLayers));
  }
  std::vector<ChannelRow> rows(static_cast<std::size_t>(count));
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    get_row(columns.entry_m, i, rows[k].entry_m);
    get_row(columns.axis, i, rows[k].axis);
    rows[k].depth_m = columns.depth_m[k];
    rows[k].layer = columns.layer[k];
    get_row(columns.layer_depth_m, i, rows[k].layer_depth_m);
    get_row(columns.layer_material, i, rows[k].layer_material);
  }
  return rows;
}

// Two hands began with the same channels: of one entry and axis, the deeper.
void put_channel(const ChannelRow& row, std::vector<ChannelRow>& channels) {
  const auto same =
      std::find_if(channels.begin(), channels.end(), [&](const ChannelRow& kept) {
        return kept.entry_m == row.entry_m && kept.axis == row.axis;
      });
  if (same == channels.end()) {
    channels.push_back(row);
    channels.back().table = 0;
  } else if (row.depth_m > same->depth_m) {
    same->depth_m = row.depth_m;
    same->layer = row.layer;
  }
}

}  // namespace

void write_surface_state(const std::filesystem::path& file, const SurfaceState& state) {
  AtomicFile atomic(file);
  StoredWriter out = make_writer(form_of(file));
  out.attribute("/", "format", std::string(kSurfaceFormat));
  const bool channels =
      std::any_of(state.tool.begin(), state.tool.end(), [](const auto& tool) {
        return !tool.second.channels.empty();
      });
  out.attribute("/", "format_version", channels ? kSurfaceStateVersion : 1);
  exchange_head(out, state);
  std::vector<std::string> names;
  for (const auto& [tool, rows] : state.tool) {
    names.push_back(tool);
  }
  out.group("/tools");
  out.attribute("/tools", "names", join_lines(names));
  for (const auto& [tool, rows] : state.tool) {
    const Columns columns = columns_of(rows.yielded);
    exchange_columns(out, tool, columns);
    if (!rows.channels.empty()) {
      const ChannelColumns cut = columns_of(rows.channels);
      exchange_channels(out, tool, cut);
    }
  }
  // The digest is of all before; as a remark it is not part of itself.
  out.remark("/", kDigestName, out.digest());
  atomic.write(out.image());
  atomic.commit();
}

SurfaceState read_surface_state(const std::filesystem::path& file) {
  StoredReader in(open_stored(file));
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
  if (version < 1 || version > kSurfaceStateVersion) {
    in.fail(fmt::format("format version is {}, must be 1 to {}", version,
                        kSurfaceStateVersion));
  }
  SurfaceState state;
  exchange_head(in, state);
  std::string names;
  in.group("/tools");
  in.attribute("/tools", "names", names);
  for (const std::string& tool : split_lines(names)) {
    Columns columns;
    exchange_columns(in, tool, columns);
    KeptSurface& kept = state.tool[tool];
    kept.yielded = rows_of_tool(in, tool, columns);
    if (version > 1 && in.has(channel_group(tool))) {
      ChannelColumns cut;
      exchange_channels(in, tool, cut);
      kept.channels = channels_of(in, tool, cut);
    }
    check_kept(kept, fmt::format("{}: /tools/{}", utf8_of(file), tool));
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
        utf8_of(file), state.database, state.database_sha256, database, sha256));
  }
  return state;
}

KeptSurface surface_of(const SurfaceState& surface,
                       const std::vector<std::string>& tables) {
  KeptSurface rows;
  for (std::size_t table = 0; table < tables.size(); ++table) {
    const auto found = surface.tool.find(tables[table]);
    if (found == surface.tool.end()) {
      continue;
    }
    const auto add = [table](const auto& from, auto& to) {
      for (const auto& row : from) {
        to.push_back(row);
        to.back().table = static_cast<std::int32_t>(table);
      }
    };
    add(found->second.yielded, rows.yielded);
    add(found->second.channels, rows.channels);
  }
  return rows;
}

void put_surface(const KeptSurface& rows, const std::vector<std::string>& tables,
                 SurfaceState& surface) {
  std::map<std::string, std::map<std::int32_t, YieldedRow>> deepest;
  for (const std::string& table : tables) {
    deepest[table];
    surface.tool[table] = {};
  }
  const auto table_of = [&](const auto& row) -> const std::string& {
    return tables.at(static_cast<std::size_t>(row.table));
  };
  for (const YieldedRow& row : rows.yielded) {
    YieldedRow& kept = deepest[table_of(row)][row.site];
    kept.site = row.site;
    kept.dent_m = std::max(kept.dent_m, row.dent_m);
    kept.softened_m = std::max(kept.softened_m, row.softened_m);
  }
  for (const auto& [table, sites] : deepest) {
    for (const auto& [site, row] : sites) {
      surface.tool[table].yielded.push_back(row);
    }
  }
  for (const ChannelRow& row : rows.channels) {
    put_channel(row, surface.tool[table_of(row)].channels);
  }
}

}  // namespace palpate
