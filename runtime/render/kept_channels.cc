#include "runtime/render/kept_channels.h"

#include <algorithm>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

static_assert(kKeptLayers == kPunctureLayers);

ChannelRow kept_row(const Channel& channel) {
  ChannelRow row{.depth_m = channel.depth_m, .layer = channel.layer};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    row.entry_m[k] = channel.entry_m[axis];
    row.axis[k] = channel.axis[axis];
  }
  row.layer_depth_m.fill(std::numeric_limits<double>::quiet_NaN());
  row.layer_material.fill(-1);
  for (std::size_t k = 0; k < static_cast<std::size_t>(channel.layers.layers); ++k) {
    row.layer_depth_m[k] = channel.layers.depth_m[k];
    row.layer_material[k] = channel.layers.material[k];
  }
  return row;
}

// What its first membrane bore is forgotten: it is broken.
Channel reopened(const ChannelRow& row) {
  Channel channel;
  channel.entry_m = Eigen::Vector3d(row.entry_m.data()).cast<Real>();
  channel.axis = Eigen::Vector3d(row.axis.data()).cast<Real>();
  channel.depth_m = static_cast<Real>(row.depth_m);
  channel.layer = row.layer;
  NodePuncture& layers = channel.layers;
  for (std::size_t k = 0; k < row.layer_material.size(); ++k) {
    if (row.layer_material[k] < 0) {
      break;
    }
    layers.depth_m[k] = static_cast<Real>(row.layer_depth_m[k]);
    layers.material[k] = static_cast<std::int8_t>(row.layer_material[k]);
    ++layers.layers;
  }
  return channel;
}

}  // namespace

std::vector<ChannelRow> channel_rows(const NeedleState& needle) {
  std::vector<ChannelRow> rows;
  std::transform(needle.channel.begin(), needle.channel.begin() + needle.channels,
                 std::back_inserter(rows), kept_row);
  return rows;
}

void begin_channels(const std::vector<ChannelRow>& rows, const PunctureRules& rules,
                    NeedleState& needle) {
  if (rows.size() > static_cast<std::size_t>(kChannels)) {
    throw InputError(
        fmt::format("a surface with {} channels of needles cannot be held, {} at most "
                    "can",
                    rows.size(), kChannels));
  }
  for (const ChannelRow& row : rows) {
    const auto most =
        *std::max_element(row.layer_material.begin(), row.layer_material.end());
    if (most >= rules.materials) {
      throw InputError(fmt::format(
          "a surface with a needle's channel through material number {}, the tool "
          "punctures {}",
          most, rules.materials));
    }
  }
  needle = {};
  std::transform(rows.begin(), rows.end(), needle.channel.begin(), reopened);
  needle.channels = static_cast<std::int32_t>(rows.size());
}

}  // namespace palpate
