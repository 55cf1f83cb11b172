#include "runtime/vendor/hd_link.h"

#include <random>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"
#include "tests/runtime/vendor/vendor_library.h"

namespace palpate {
namespace {

const Eigen::Vector3d kTouchPush(0.1, 0.2, -0.3);

class HdDevice : public testing::Test {
 protected:
  void SetUp() override { config_.library = library_.path(); }

  void push_error(unsigned code) {
    library_.function<void(unsigned)>("stand_in_push_error")(code);
  }

  // Exchanges until the motors give kTouchPush, which is the tick after the next at
  // most.
  void push(HdLink& link) {
    Eigen::Vector3d position_m;
    for (int i = 0; i < 5; ++i) {
      ASSERT_NE(link.transact(kTouchPush, position_m), LinkStatus::kLost);
    }
    ASSERT_EQ(library_.force_n(), kTouchPush);
  }

  void sleep_ms(int milliseconds) {
    MonotonicClock clock;
    clock.sleep_until_ns(clock.now_ns() + std::int64_t{1'000'000} * milliseconds);
  }

  test::VendorLibrary library_{"libHD.so"};
  HdConfig config_;
};

TEST_F(HdDevice, IsPushedFromTheLibrarysThreadAndLetGo) {
  for (int session = 0; session < 2; ++session) {
    HdLink link(config_);
    link.open();
    EXPECT_EQ(link.limits().force_max_n, 0.88);  // the library's nominal force
    Eigen::Vector3d first_m;
    Eigen::Vector3d then_m;
    ASSERT_EQ(link.transact(kTouchPush, first_m), LinkStatus::kOk);
    push(link);
    ASSERT_EQ(link.transact(kTouchPush, then_m), LinkStatus::kOk);
    EXPECT_GT((then_m - first_m).dot(kTouchPush), 0.0);
    EXPECT_LT((then_m - first_m).norm(), 1e-3);  // millimetres there, metres here
    link.close();
    EXPECT_EQ(library_.force_n(), Eigen::Vector3d::Zero());
    EXPECT_EQ(library_.variable<int>("stand_in_running"), 0);
  }
}

TEST_F(HdDevice, ThatIsNotCalibratedIsRefused) {
  for (const unsigned wants : {0x5001U, 0x5002U}) {
    library_.variable<unsigned>("stand_in_calibration") = wants;
    HdLink link(config_);
    try {
      link.open();
      FAIL() << "opened";
    } catch (const DeviceError& error) {
      EXPECT_NE(std::string(error.what()).find("not calibrated"), std::string::npos)
          << error.what();
    }
    EXPECT_EQ(library_.variable<int>("stand_in_running"), 0);
  }
  library_.variable<unsigned>("stand_in_calibration") = 0x5000;
}

// About the library's y axis, which is ours; by columns.
TEST_F(HdDevice, TurnsTheToolAsItsStylusIsTurned) {
  const auto turn = [this](double angle_rad) {
    Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();
    transform.topLeftCorner<3, 3>() =
        Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
    transform.col(3).head<3>() << 10.0, 20.0, 30.0;
    library_.function<void(const double*)>("stand_in_turn")(transform.data());
  };
  HdLink link(config_);
  link.open();
  ASSERT_TRUE(link.measures_turns());
  turn(0.3);
  push(link);
  EXPECT_LT(link.turn().angularDistance(
                Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()))),
            1e-7);
  const Eigen::Matrix4d none = Eigen::Matrix4d::Zero();
  library_.function<void(const double*)>("stand_in_turn")(none.data());
  Eigen::Vector3d position_m;
  LinkStatus status = LinkStatus::kOk;
  for (int i = 0; i < 5 && status != LinkStatus::kLost; ++i) {
    status = link.transact(kTouchPush, position_m);
  }
  EXPECT_EQ(status, LinkStatus::kLost);
  EXPECT_EQ(link.failure(), "its library says an orientation that is none");
  sleep_ms(10);
  EXPECT_EQ(library_.force_n(), Eigen::Vector3d::Zero());
  link.close();
  HdLink again(config_);
  again.open();  // of a library that says no transform
  EXPECT_FALSE(again.measures_turns());
  turn(0.0);
}

TEST_F(HdDevice, LetsGoWhenNobodyRenewsTheForce) {
  HdLink link(config_);
  link.open();
  push(link);
  sleep_ms(60);
  EXPECT_EQ(library_.force_n(), Eigen::Vector3d::Zero());
}

TEST_F(HdDevice, AnythingOnTheStackOfErrorsEndsIt) {
  HdLink link(config_);
  link.open();
  push(link);
  push_error(0x0301);
  Eigen::Vector3d position_m;
  LinkStatus status = LinkStatus::kOk;
  for (int i = 0; i < 5 && status != LinkStatus::kLost; ++i) {
    status = link.transact(kTouchPush, position_m);
  }
  EXPECT_EQ(status, LinkStatus::kLost);
  EXPECT_EQ(link.failure(), "Warm motors");
  sleep_ms(10);
  EXPECT_EQ(library_.force_n(), Eigen::Vector3d::Zero());
}

TEST_F(HdDevice, UnpluggedAtAnyTickIsALossWithZeroForce) {
  std::mt19937 random(27);
  std::uniform_int_distribution<int> many(1, 10);
  for (int i = 0; i < 200; ++i) {
    HdLink link(config_);
    link.open();
    Eigen::Vector3d position_m;
    for (int k = many(random); k > 0; --k) {
      ASSERT_NE(link.transact(kTouchPush, position_m), LinkStatus::kLost);
    }
    push_error(0x0201);
    LinkStatus status = LinkStatus::kOk;
    for (int k = 0; k < 5 && status != LinkStatus::kLost; ++k) {
      status = link.transact(kTouchPush, position_m);
    }
    ASSERT_EQ(status, LinkStatus::kLost);
    EXPECT_EQ(link.failure(), "Device fault");
    link.close();
    EXPECT_EQ(library_.force_n(), Eigen::Vector3d::Zero());
  }
}

TEST_F(HdDevice, ASchedulerThatStandsStillIsLost) {
  HdLink link(config_);
  link.open();
  library_.variable<int>("stand_in_stalls") = 1;
  sleep_ms(5);
  Eigen::Vector3d position_m;
  EXPECT_EQ(link.transact(kTouchPush, position_m), LinkStatus::kMissed);
  EXPECT_EQ(link.sent_n(), Eigen::Vector3d::Zero());
  int more = 0;
  while (link.transact(kTouchPush, position_m) == LinkStatus::kMissed && more < 100) {
    ++more;
  }
  EXPECT_EQ(more, 9);
  EXPECT_EQ(link.failure(), "its scheduler has stopped");
  library_.variable<int>("stand_in_stalls") = 0;
}

TEST_F(HdDevice, OpensByNameOrSaysWhyNot) {
  config_.device = "Left";
  HdLink(config_).open();
  config_.device = "Right";
  try {
    HdLink(config_).open();
    FAIL() << "opened";
  } catch (const DeviceError& error) {
    EXPECT_STREQ(error.what(), "openhaptics: no device: Device fault (error 0x0201)");
  }
  config_.library = "libHD.so-that-nobody-has";
  EXPECT_THROW(HdLink(config_).open(), DeviceError);
}

}  // namespace
}  // namespace palpate
