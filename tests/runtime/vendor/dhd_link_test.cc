#include "runtime/vendor/dhd_link.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"
#include "tests/runtime/vendor/vendor_library.h"

namespace palpate {
namespace {

const Eigen::Vector3d kPush(0.5, 0.25, -1.0);

class DhdDevice : public testing::Test {
 protected:
  void SetUp() override { config_.library = library_.path(); }

  [[nodiscard]] std::string opening_error() {
    try {
      DhdLink(config_).open();
    } catch (const DeviceError& error) {
      return error.what();
    }
    return "";
  }

  test::VendorLibrary library_{"libdhd.so.3"};
  DhdConfig config_;
};

TEST_F(DhdDevice, IsPushedInOurAxesAndLetGo) {
  DhdLink link(config_);
  link.open();
  EXPECT_EQ(library_.variable<std::int64_t>("stand_in_watchdog_ns"), 20'000'000);
  Eigen::Vector3d position_m;
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kOk);
  }
  EXPECT_EQ(library_.force_n(), Eigen::Vector3d(-1.0, 0.5, 0.25));
  EXPECT_TRUE(position_m.isApprox(1e-4 * kPush, 1e-9));  // 1e-5 m each
  ASSERT_EQ(link.transact(100.0 * kPush, position_m), LinkStatus::kOk);
  EXPECT_NEAR(library_.force_n().norm(), 8.0, 1e-9);
  EXPECT_TRUE(link.sent_n().isApprox(8.0 * kPush.normalized()));
  link.close();
  EXPECT_EQ(library_.force_n(), Eigen::Vector3d::Zero());
  EXPECT_EQ(library_.variable<int>("stand_in_enabled"), 0);
}

TEST_F(DhdDevice, ThatIsNotCalibratedIsRefused) {
  library_.variable<int>("stand_in_calibrated") = 0;
  EXPECT_NE(opening_error().find("not calibrated"), std::string::npos);
  EXPECT_EQ(library_.variable<int>("stand_in_open"), 0);
  library_.variable<int>("stand_in_calibrated") = 1;
  EXPECT_EQ(opening_error(), "");
}

// An eighth about the library's z axis, which is our y.
TEST_F(DhdDevice, WithAWristTurnsTheTool) {
  auto& frame = library_.variable<double[3][3]>("stand_in_frame");
  const double upright[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const int wrist : {0, 1}) {
    library_.variable<int>("stand_in_has_wrist") = wrist;
    std::copy_n(&upright[0][0], 9, &frame[0][0]);
    DhdLink link(config_);
    link.open();
    EXPECT_EQ(link.measures_turns(), wrist == 1);
    const double c = std::sqrt(0.5);
    const double turned[3][3] = {{c, -c, 0}, {c, c, 0}, {0, 0, 1}};
    std::copy_n(&turned[0][0], 9, &frame[0][0]);
    Eigen::Vector3d position_m;
    ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kOk);
    const Eigen::Quaterniond wanted(
        Eigen::AngleAxisd(wrist * 0.25 * std::numbers::pi, Eigen::Vector3d::UnitY()));
    EXPECT_LT(link.turn().angularDistance(wanted), 1e-7);
    frame[0][0] = 2.0;
    EXPECT_EQ(link.transact(kPush, position_m),
              wrist == 1 ? LinkStatus::kLost : LinkStatus::kOk);
    EXPECT_EQ(link.failure(),
              wrist == 1 ? "its library says an orientation that is none" : "");
    EXPECT_EQ(library_.force_n() == Eigen::Vector3d::Zero(), wrist == 1);
  }
  library_.variable<int>("stand_in_has_wrist") = 0;
  std::copy_n(&upright[0][0], 9, &frame[0][0]);
}

// The device's own: nothing of ours runs meanwhile.
TEST_F(DhdDevice, HasItsForceTakenAwayByItsWatchdog) {
  DhdLink link(config_);
  link.open();
  Eigen::Vector3d position_m;
  ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kOk);
  MonotonicClock clock;
  clock.sleep_until_ns(clock.now_ns() + 30'000'000);
  EXPECT_EQ(library_.force_n(), Eigen::Vector3d::Zero());
}

TEST_F(DhdDevice, WithoutAWatchdogIsSaidToBe) {
  library_.variable<int>("stand_in_has_watchdog") = 0;
  std::string told;
  config_.tell = [&told](const std::string& text) {
    told += text;
  };
  EXPECT_EQ(opening_error(), "");
  EXPECT_NE(told.find("no watchdog of its own"), std::string::npos) << told;
  library_.variable<int>("stand_in_has_watchdog") = 1;
}

TEST_F(DhdDevice, EndsByTheLibrarysWords) {
  library_.variable<int>("stand_in_has_device") = 0;
  EXPECT_EQ(opening_error(), "dhd: no device: no device found");
  library_.variable<int>("stand_in_has_device") = 1;
  DhdLink link(config_);
  link.open();
  Eigen::Vector3d position_m;
  ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kOk);
  library_.variable<int>("stand_in_fails") = 1;
  EXPECT_EQ(link.transact(kPush, position_m), LinkStatus::kLost);
  EXPECT_EQ(link.failure(), "communication error");
  EXPECT_EQ(library_.force_n(), Eigen::Vector3d::Zero());
  library_.variable<int>("stand_in_fails") = 0;
  EXPECT_EQ(link.transact(kPush, position_m), LinkStatus::kLost);  // for good
}

TEST_F(DhdDevice, UnpluggedAtAnyExchangeIsALossWithZeroForce) {
  std::mt19937 random(27);
  std::uniform_int_distribution<int> many(1, 40);
  for (int i = 0; i < 200; ++i) {
    DhdLink link(config_);
    link.open();
    Eigen::Vector3d position_m;
    for (int k = many(random); k > 0; --k) {
      ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kOk);
    }
    library_.variable<int>("stand_in_fails") = 1;
    ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kLost);
    EXPECT_EQ(link.failure(), "communication error");
    EXPECT_EQ(library_.force_n(), Eigen::Vector3d::Zero());
    library_.variable<int>("stand_in_fails") = 0;
  }
}

TEST_F(DhdDevice, WithoutItsLibraryIsOneSentence) {
  config_.library = "libdhd.so.3-that-nobody-has";
  const std::string text = opening_error();
  EXPECT_NE(text.find("of Force Dimension cannot be loaded"), std::string::npos)
      << text;
  config_.library = "libc.so.6";
  EXPECT_NE(opening_error().find("has no dhdOpen()"), std::string::npos);
}

}  // namespace
}  // namespace palpate
