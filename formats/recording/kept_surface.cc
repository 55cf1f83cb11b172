#include "formats/recording/kept_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kUnit = 1e-6;  // an axis' length may be off by

[[noreturn]] void fail(const std::string& where, const std::string& what) {
  throw FormatError(fmt::format("{}: {}", where, what));
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
        fail(where, fmt::format("site {} has a depth of {} m, must be finite and not "
                                "negative",
                                row.site, depth_m));
      }
    }
  }
}

// Layers of a channel: the first ones, one or more; nothing behind them.
bool are_layers(const ChannelRow& row) {
  std::int32_t layers = 0;
  for (std::size_t k = 0; k < row.layer_depth_m.size(); ++k) {
    if (std::isnan(row.layer_depth_m[k]) && row.layer_material[k] == -1) {
      continue;
    }
    const double least_m = k == 0 ? 0.0 : row.layer_depth_m[k - 1];
    const bool rises =
        k == 0 ? row.layer_depth_m[k] == 0.0
               : std::isfinite(row.layer_depth_m[k]) && row.layer_depth_m[k] > least_m;
    if (static_cast<std::size_t>(layers) != k || !rises || row.layer_material[k] < 0 ||
        row.layer_material[k] > std::numeric_limits<std::int8_t>::max()) {
      return false;
    }
    ++layers;
  }
  return row.layer >= 0 && row.layer < layers;
}

void check_channels(const std::vector<ChannelRow>& rows, const std::string& where) {
  std::int32_t table = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ChannelRow& row = rows[i];
    if (row.table < table) {
      fail(where, fmt::format("channel {} has table {} after {}, must rise from 0 on",
                              i, row.table, table));
    }
    table = row.table;
    const bool finite =
        std::all_of(row.entry_m.begin(), row.entry_m.end(), [](double x) {
          return std::isfinite(x);
        });
    const double length = std::hypot(row.axis[0], row.axis[1], row.axis[2]);
    if (!finite || !(std::abs(length - 1.0) <= kUnit)) {
      fail(where, fmt::format("channel {} enters at {} along {}, must be finite and "
                              "a unit vector",
                              i, row.entry_m, row.axis));
    }
    if (!(row.depth_m >= 0.0) || !std::isfinite(row.depth_m)) {
      fail(where, fmt::format("channel {} has a depth of {} m, must be finite and not "
                              "negative",
                              i, row.depth_m));
    }
    if (!are_layers(row)) {
      fail(where,
           fmt::format("channel {} has the layers {} of materials {}, the tip in layer "
                       "{}: they must rise from 0 on, and the tip be in one",
                       i, row.layer_depth_m, row.layer_material, row.layer));
    }
  }
}

}  // namespace

bool ChannelRow::operator==(const ChannelRow& other) const noexcept {
  const auto same = [](double a, double b) {
    return a == b || (std::isnan(a) && std::isnan(b));
  };
  return entry_m == other.entry_m && axis == other.axis && depth_m == other.depth_m &&
         layer == other.layer && layer_material == other.layer_material &&
         table == other.table &&
         std::equal(layer_depth_m.begin(), layer_depth_m.end(),
                    other.layer_depth_m.begin(), same);
}

YieldedRow largest_of(const std::vector<YieldedRow>& rows) {
  YieldedRow largest;
  for (const YieldedRow& row : rows) {
    largest.dent_m = std::max(largest.dent_m, row.dent_m);
    largest.softened_m = std::max(largest.softened_m, row.softened_m);
  }
  return largest;
}

void check_kept(const KeptSurface& surface, const std::string& where) {
  check_yielded(surface.yielded, where);
  check_channels(surface.channels, where);
}

}  // namespace palpate
