// Channels leave a needle's state and come back into one.
#include "runtime/render/kept_channels.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/layered_body.h"

namespace palpate {
namespace {

// Two channels, the needle in the second.
NeedleState needle_in_tissue() {
  NeedleState needle;
  needle.channels = 2;
  needle.active = 1;
  needle.broken = 3;
  for (std::size_t i = 0; i < 2; ++i) {
    Channel& channel = needle.channel[i];
    channel.entry_m = {0.01, 0.02, 0.003 * static_cast<double>(i)};
    channel.axis = Vector3(0.0, 0.6, 0.8);
    channel.layers = layered_node(kSkinN);
    channel.layer = static_cast<std::int32_t>(i);
    channel.depth_m = 0.001 + 0.004 * static_cast<double>(i);
    channel.inserted_m = 0.001;
    channel.shaft_m = 1e-4;
  }
  return needle;
}

TEST(KeptChannels, AreWhatTheNeedleLeavesWithoutTheNeedle) {
  const std::vector<ChannelRow> rows = channel_rows(needle_in_tissue());
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1].depth_m, 0.005);
  EXPECT_EQ(rows[1].layer, 1);
  EXPECT_EQ(rows[1].layer_depth_m[2], 0.012);
  EXPECT_EQ(rows[1].layer_material[2], 2);
  EXPECT_TRUE(std::isnan(rows[1].layer_depth_m[3]));
  EXPECT_EQ(rows[1].layer_material[3], -1);
  EXPECT_NO_THROW(check_kept({.channels = rows}, "a run"));

  NeedleState next;
  next.shaft_j = 1.0;
  begin_channels(rows, layered_rules(), next);
  EXPECT_EQ(next.channels, 2);
  EXPECT_EQ(next.active, -1);
  EXPECT_EQ(next.shaft_j, 0.0);
  EXPECT_EQ(next.channel[1].inserted_m, 0.0);
  EXPECT_EQ(next.channel[1].shaft_m, 0.0);
  EXPECT_EQ(next.channel[1].layers.layers, 3);
  EXPECT_EQ(boundary_m(next.channel[1]), 0.012);
  EXPECT_EQ(cutting_n(layered_rules(), next.channel[1]), 0.2);
  EXPECT_EQ(channel_rows(next), rows);
}

TEST(KeptChannels, ThatFindNoRoomOrNoMaterialAreRefused) {
  const std::vector<ChannelRow> rows = channel_rows(needle_in_tissue());
  NeedleState state = needle_in_tissue();
  EXPECT_THROW(begin_channels(std::vector<ChannelRow>(kChannels + 1, rows[0]),
                              layered_rules(), state),
               InputError);
  PunctureRules fewer = layered_rules();
  fewer.materials = 2;
  EXPECT_THROW(begin_channels(rows, fewer, state), InputError);
  EXPECT_THROW(begin_channels(rows, {}, state), InputError);  // no needle
  EXPECT_EQ(channel_rows(state), rows);
  EXPECT_EQ(state.active, 1);
  EXPECT_NO_THROW(begin_channels({}, {}, state));
  EXPECT_EQ(state.channels, 0);
}

}  // namespace
}  // namespace palpate
