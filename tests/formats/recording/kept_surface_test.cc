// What a kept surface may hold.
#include "formats/recording/kept_surface.h"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/said.h"

namespace palpate {
namespace {

ChannelRow some_channel() {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return {.entry_m = {0.1, 0.3, -0.02},
          .axis = {0.6, 0.0, 0.8},
          .depth_m = 0.005,
          .layer = 1,
          .layer_depth_m = {0.0, 0.002, 0.01, kNone, kNone, kNone},
          .layer_material = {2, 0, 7, -1, -1, -1}};
}

template <typename Breaks>
std::string said_of(Breaks breaks) {
  ChannelRow broken = some_channel();
  breaks(broken);
  return refusal([&] {
    check_kept({.channels = {some_channel(), broken}}, "s.h5: /tools/ball");
  });
}

TEST(KeptSurface, ChannelsThatAreNoneAreRefused) {
  EXPECT_EQ(said_of([](ChannelRow&) {}), "");
  EXPECT_NE(said_of([](ChannelRow& c) {
              c.depth_m = -1e-9;
            }).find("/tools/ball: channel 1 has a depth of -1e-09 m"),
            std::string::npos);
  EXPECT_NE(said_of([](ChannelRow& c) {
              c.axis[2] = 0.81;
            }).find("must be finite and a unit vector"),
            std::string::npos);
  EXPECT_NE(said_of([](ChannelRow& c) {
              c.layer = 3;
            }).find("the tip in layer 3"),
            std::string::npos);
  EXPECT_NE(said_of([](ChannelRow& c) {
              c.entry_m[0] = std::nan("");
            }),
            "");
  EXPECT_NE(said_of([](ChannelRow& c) {
              c.depth_m = std::nan("");
            }),
            "");
  EXPECT_NE(said_of([](ChannelRow& c) {
              c.layer = -1;
            }),
            "");
  EXPECT_NE(said_of([](ChannelRow& c) {
              c.layer_depth_m[0] = 1e-3;
            }),
            "");
  EXPECT_NE(said_of([](ChannelRow& c) {
              c.layer_depth_m[2] = 0.002;
            }),
            "");
  EXPECT_NE(said_of([](ChannelRow& c) {
              c.layer_material[1] = -1;
            }),
            "");
  EXPECT_NE(said_of([](ChannelRow& c) {
              c.layer_material[2] = 128;
            }),
            "");
  EXPECT_NE(said_of([](ChannelRow& c) {
              c.layer_material[4] = 1;
            }),
            "");
  EXPECT_NE(said_of([](ChannelRow& c) {
              c.table = -1;
            }),
            "");
}

TEST(KeptSurface, ChannelsAreEqualWhereTheirMissingLayersAre) {
  ChannelRow other = some_channel();
  EXPECT_EQ(other, some_channel());
  other.layer_depth_m[3] = 0.02;
  EXPECT_NE(other, some_channel());
}

TEST(KeptSurface, LargestIsOfEachDepthByItself) {
  const YieldedRow largest = largest_of({{1, 0.2, 0.1}, {7, 0.1, 0.5}});
  EXPECT_EQ(largest.dent_m, 0.2);
  EXPECT_EQ(largest.softened_m, 0.5);
  EXPECT_EQ(largest.site, -1);
  EXPECT_EQ(largest_of({}).dent_m, 0.0);
}

}  // namespace
}  // namespace palpate
