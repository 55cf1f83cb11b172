// A host that presses with a needle, through palpate_needle.h and palpate.hpp.
#include "runtime/c_api/palpate_needle.h"

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "runtime/c_api/palpate.hpp"
#include "tests/support/allocation_guard.h"
#include "tests/support/punctured_plate.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr double kThroughM = 0.014;  // of the tip, above bone
constexpr double kCutJ = 0.5 * 0.002 + 0.2 * (kPlateBoneM - 0.002);

class PalpateNeedle : public testing::Test {
 protected:
  void SetUp() override {
    ResponseDatabase database = punctured_plate();
    write_database(file_, database);
    database.tools[0].puncture = {};
    write_database(blunt_, database);
  }

  static palpate_options options() {
    palpate_options all = default_options();
    all.flags = PALPATE_OWN_SLOW_STEPS;
    return all;
  }

  // Straight to a depth of the tip, 10 um a tick.
  Tick go_to(Body& body, Tool& tool, double depth_m, double unit = 1.0) {
    Tick tick;
    const int ticks =
        static_cast<int>(std::lround(std::abs(depth_m - depth_m_) / 1e-5));
    const double from_m = depth_m_;
    for (int i = 1; i <= ticks; ++i) {
      depth_m_ = from_m + (depth_m - from_m) * i / ticks;
      const Eigen::Vector3d at =
          world_ * Eigen::Vector3d(x_m_, 0.002, kPlateNeedleM - depth_m_) / unit;
      tick = tool.step({{at.x(), at.y(), at.z()}, {}}, 0.001);
      if (i % 5 == 0) {
        (void)body.slow_step();
      }
    }
    return tick;
  }

  ScratchFolder folder_;
  std::string file_ = (folder_ / "needle.h5").string();
  std::string blunt_ = (folder_ / "blunt.h5").string();
  Eigen::Isometry3d world_ = Eigen::Isometry3d::Identity();
  double x_m_ = 0.001;
  double depth_m_ = -0.002;
};

TEST_F(PalpateNeedle, PressesThroughAMembraneAndReadsItsChannel) {
  Body body(file_, options());
  Tool tool = body.add_tool();
  Tick tick = go_to(body, tool, 0.0099);
  EXPECT_NEAR(tick.hand[0].force[2], plate_n(0.0099), 2e-3);
  EXPECT_TRUE(tool.channels().empty());
  EXPECT_EQ(tool.needle().channel, -1);
  tick = go_to(body, tool, kThroughM);
  // The rest of the curve bears on bone, friction on the shaft.
  const palpate_needle needle = tool.needle();
  EXPECT_NEAR(needle.tip_force, plate_n(kThroughM - kPlateBoneM), 2e-3);
  EXPECT_NEAR(needle.shaft_force, plate_shaft_n(), 1e-6);
  EXPECT_NEAR(tick.hand[0].force[2], needle.tip_force + needle.shaft_force, 1e-12);
  EXPECT_EQ(needle.channels, 1);
  EXPECT_EQ(needle.channel, 0);
  EXPECT_EQ(needle.broken, 2U);
  EXPECT_EQ(needle.refused, 0U);
  EXPECT_NEAR(needle.tip_depth, kThroughM, 1e-9);
  EXPECT_NEAR(needle.inserted, kPlateBoneM, 1e-9);
  EXPECT_NEAR(needle.cut_j, kCutJ, 1e-6);
  EXPECT_GT(needle.released_j, 0.0);
  EXPECT_GT(needle.shaft_j, 0.0);
  const palpate_state state = tool.state();
  EXPECT_NEAR(needle.cut_j + needle.released_j + needle.shaft_j, state.dissipated_j,
              1e-12);
  EXPECT_NEAR(state.work_j, state.dissipated_j + state.stored_j, 1e-12);
  ASSERT_EQ(tool.channels().size(), 1U);
  const palpate_channel channel = tool.channels()[0];
  EXPECT_NEAR(channel.entry[2], kPlateNeedleM, 1e-9);
  EXPECT_NEAR(channel.axis[2], 1.0, 1e-12);
  EXPECT_NEAR(channel.depth, kPlateBoneM, 1e-12);
  EXPECT_EQ(channel.layer, 1);
  EXPECT_EQ(channel.layers, 3);
  EXPECT_NEAR(channel.boundary, kPlateBoneM, 1e-12);
}

// In the host's units, and where the body stands.
TEST_F(PalpateNeedle, IsReadInTheHostsUnitsAndWorld) {
  palpate_options all = options();
  all.metres_per_unit = 0.001;
  all.newtons_per_unit = 0.01;
  Body body(file_, all);
  world_.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()));
  world_.pretranslate(Eigen::Vector3d(0.3, -0.2, 1.0));
  const Eigen::Vector3d origin = 1e3 * world_.translation();
  const Eigen::Vector4d turn = Eigen::Quaterniond(world_.rotation()).coeffs();
  body.place({origin.x(), origin.y(), origin.z()},
             {turn[0], turn[1], turn[2], turn[3]});
  Tool tool = body.add_tool();
  (void)go_to(body, tool, kThroughM, 0.001);
  // Aside: the channel holds the shaft across.
  x_m_ += 1e-4;
  depth_m_ -= 1e-5;
  (void)go_to(body, tool, kThroughM, 0.001);
  const palpate_needle needle = tool.needle();
  EXPECT_NEAR(needle.tip_force, 1e2 * plate_n(kThroughM - kPlateBoneM), 0.2);
  EXPECT_NEAR(needle.tip_depth, 1e3 * kThroughM, 1e-6);
  EXPECT_NEAR(needle.inserted, 10.0, 1e-6);
  const Eigen::Vector3d across =
      world_.rotation().transpose() * Eigen::Vector3d(needle.lateral_force);
  EXPECT_NEAR(across.x(), -1e2 * 5e4 * kPlateBoneM * 1e-4, 1e-3);
  EXPECT_NEAR(across.z(), 0.0, 1e-9);
  const palpate_channel channel = tool.channels().at(0);
  const Eigen::Vector3d entry =
      world_.inverse() * (1e-3 * Eigen::Vector3d(channel.entry));
  EXPECT_NEAR((entry - Eigen::Vector3d(0.001, 0.002, kPlateNeedleM)).norm(), 0.0, 1e-8);
  EXPECT_NEAR((Eigen::Vector3d(channel.axis) - world_.rotation().col(2)).norm(), 0.0,
              1e-9);
  EXPECT_NEAR(channel.depth, 10.0, 1e-9);
  EXPECT_NEAR(channel.boundary, 10.0, 1e-9);
}

TEST_F(PalpateNeedle, KeepsItsChannelsWhenItLeavesAndWhenItIsReset) {
  Body body(file_, options());
  Tool tool = body.add_tool();
  (void)go_to(body, tool, 0.0105);
  const Tick out = go_to(body, tool, 0.004);
  EXPECT_LT(tool.needle().shaft_force, 0.0);
  EXPECT_NEAR(tool.needle().inserted, 0.004, 1e-9);
  EXPECT_EQ(tool.needle().tip_force, 0.0);
  EXPECT_NEAR(out.hand[0].force[2], tool.needle().shaft_force, 1e-12);
  (void)go_to(body, tool, -0.002);
  EXPECT_EQ(tool.needle().channel, -1);
  EXPECT_EQ(tool.needle().tip_depth, 0.0);
  x_m_ = 0.021;
  (void)go_to(body, tool, kThroughM);
  EXPECT_EQ(tool.needle().channel, 1);
  const std::vector<palpate_channel> channels = tool.channels();
  ASSERT_EQ(channels.size(), 2U);
  EXPECT_NEAR(channels[0].entry[0], 0.001, 1e-9);
  EXPECT_NEAR(channels[1].entry[0], 0.021, 1e-9);
  EXPECT_LT(channels[0].depth, channels[1].depth);
  tool.reset();
  EXPECT_EQ(tool.needle().channel, -1);
  EXPECT_EQ(tool.channels().size(), 2U);
}

// What another tool of the body has cut open, a tool does not find.
TEST_F(PalpateNeedle, ChannelsAreTheToolsOwn) {
  Body body(file_, options());
  Tool first = body.add_tool();
  (void)go_to(body, first, kThroughM);
  Tool second = body.add_tool();
  depth_m_ = -0.002;
  const Tick tick = go_to(body, second, 0.0099);
  EXPECT_NEAR(tick.hand[0].force[2], plate_n(0.0099), 2e-3);
  EXPECT_TRUE(second.channels().empty());
  EXPECT_EQ(first.channels().size(), 1U);
}

TEST_F(PalpateNeedle, IsReadWithoutAllocation) {
  Body body(file_, options());
  Tool tool = body.add_tool();
  (void)go_to(body, tool, kThroughM);
  palpate_needle needle{};
  needle.struct_size = sizeof needle;
  palpate_channel channel{};
  const test::AllocationGuard guard;
  EXPECT_EQ(palpate_needle_get(tool.handle(), &needle, nullptr, 0), 0);
  EXPECT_EQ(
      palpate_channels_get(tool.handle(), &channel, 1, sizeof channel, nullptr, 0), 1);
}

TEST_F(PalpateNeedle, OlderAndNewerHostsHaveTheirOwnStructs) {
  Body body(file_, options());
  Tool tool = body.add_tool();
  (void)go_to(body, tool, kThroughM);
  const palpate_needle whole = tool.needle();
  palpate_needle older;
  std::memset(&older, 0xAA, sizeof older);
  older.struct_size = offsetof(palpate_needle, tip_force);
  EXPECT_EQ(palpate_needle_get(tool.handle(), &older, nullptr, 0), 0);
  EXPECT_EQ(older.inserted, whole.inserted);
  EXPECT_NE(older.tip_force, whole.tip_force);
  constexpr std::size_t kWide = sizeof(palpate_channel) + 8;
  std::vector<unsigned char> wide(kWide + 1, 0xAA);
  EXPECT_EQ(palpate_channels_get(tool.handle(),
                                 reinterpret_cast<palpate_channel*>(wide.data()), 1,
                                 kWide, nullptr, 0),
            1);
  const palpate_channel channel = tool.channels().at(0);
  EXPECT_EQ(std::memcmp(wide.data(), &channel, sizeof channel), 0);
  EXPECT_EQ(wide[kWide - 1], 0);
  EXPECT_EQ(wide[kWide], 0xAA);
  EXPECT_EQ(palpate_channels_get(tool.handle(), nullptr, 0, kWide, nullptr, 0), 1);
}

TEST_F(PalpateNeedle, WrongCallsSayWhy) {
  Body blunt(blunt_, options());
  Tool ball = blunt.add_tool();
  const auto refused = [](const auto& call) {
    try {
      (void)call();
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string why =
      "the tool is no needle: its database does not say what it punctures";
  EXPECT_EQ(refused([&] {
              return ball.needle();
            }),
            why);
  EXPECT_EQ(refused([&] {
              return ball.channels();
            }),
            why);
  Body body(file_, options());
  Tool tool = body.add_tool();
  char error[128] = "x";
  palpate_needle needle{};
  EXPECT_EQ(palpate_needle_get(tool.handle(), &needle, error, sizeof error),
            PALPATE_ERROR_INPUT);
  EXPECT_NE(std::string(error).find("size"), std::string::npos);
  needle.struct_size = sizeof needle;
  EXPECT_EQ(palpate_needle_get(nullptr, &needle, error, sizeof error),
            PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_needle_get(tool.handle(), nullptr, nullptr, 0),
            PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_needle_get(tool.handle(), &needle, error, sizeof error), 0);
  EXPECT_EQ(std::string(error), "");
  palpate_channel channel{};
  EXPECT_EQ(palpate_channels_get(tool.handle(), nullptr, 1, sizeof channel, error,
                                 sizeof error),
            PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_channels_get(tool.handle(), &channel, 1, 0, error, sizeof error),
            PALPATE_ERROR_INPUT);
  EXPECT_NE(refused([&] {
              return body.add_together();
            }).find("\"ball\" is a needle, and contacts that are coupled"),
            std::string::npos);
  palpate_options element = options();
  element.model = "element";
  EXPECT_NE(refused([&] {
              Body other(file_, element);
              return other.add_tool();
            }).find("a needle needs the model potential or facets"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate
