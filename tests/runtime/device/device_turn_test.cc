// Orientations over a driver's socket: what is one, whose zero it has, and that what is
// none ends the run.
#include "runtime/device/device_turn.h"

#include <array>
#include <limits>
#include <thread>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/device/device_driver.h"
#include "runtime/device/socket_device.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Eigen::Quaterniond about(const Eigen::Vector3d& axis, double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis));
}

TEST(ExactTurn, DividesByANormNearOneAndRefusesTheRest) {
  const Eigen::Quaterniond turn = about(Eigen::Vector3d(1, 2, 3).normalized(), 0.4);
  for (const double norm : {1.0, 0.991, 1.009}) {
    const auto found = exact_turn(Eigen::Quaterniond(norm * turn.coeffs()));
    ASSERT_TRUE(found);
    EXPECT_LT(found->angularDistance(turn), 1e-7);
    EXPECT_NEAR(found->norm(), 1.0, 1e-15);
  }
  for (const double norm : {0.0, 0.98, 1.02, -0.5, 1e300, kNan}) {
    EXPECT_FALSE(exact_turn(Eigen::Quaterniond(norm * turn.coeffs()))) << norm;
  }
  EXPECT_FALSE(exact_turn(Eigen::Quaterniond(1.0, 0.0, kNan, 0.0)));
}

TEST(ExactTurn, OfAMatrixIsARotationOrNothing) {
  const Eigen::Quaterniond turn = about(Eigen::Vector3d(1, -2, 3).normalized(), 2.9);
  Eigen::Matrix3d matrix = turn.toRotationMatrix();
  const auto found = exact_turn(Eigen::Matrix3d(1.002 * matrix));
  ASSERT_TRUE(found);
  EXPECT_LT(found->angularDistance(turn), 1e-2);
  EXPECT_FALSE(exact_turn(Eigen::Matrix3d(-matrix)));  // a mirror
  EXPECT_FALSE(exact_turn(Eigen::Matrix3d(1.1 * matrix)));
  EXPECT_FALSE(exact_turn(Eigen::Matrix3d(Eigen::Matrix3d::Zero())));
  matrix(1, 2) = kNan;
  EXPECT_FALSE(exact_turn(matrix));
}

TEST(TurnFromStart, IsAboutTheDevicesAxesWhereverTheGripsZeroIs) {
  const Eigen::Quaterniond zero = about(Eigen::Vector3d(3, 1, -1).normalized(), 1.3);
  const Eigen::Quaterniond turn = about(Eigen::Vector3d::UnitX(), 0.2);
  TurnFromStart from_start;
  EXPECT_LT(from_start(zero).angularDistance(Eigen::Quaterniond::Identity()), 1e-7);
  EXPECT_LT(from_start(turn * zero).angularDistance(turn), 1e-7);
}

class DriverSocket : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends_.data()), 0);
  }
  void TearDown() override { ::close(ends_[1]); }

  template <typename Datagram>
  void say(const Datagram& datagram) {
    ASSERT_EQ(::send(ends_[1], &datagram, sizeof datagram, 0),
              static_cast<ssize_t>(sizeof datagram));
  }

  void say_turned(std::array<double, 4> wxyz) {
    MonotonicClock clock;
    SocketTurnedState turned;
    turned.state.time_ns = clock.now_ns();
    turned.state.position_m = {0.1, 0.2, 0.3};
    turned.turn_wxyz = wxyz;
    say(turned);
  }

  std::array<int, 2> ends_{};
};

TEST_F(DriverSocket, CarriesTurnsWhereItsHelloSaysSo) {
  say(SocketHello{.magic = kTurnedHello, .force_max_n = 5.0});
  SocketDevice device(ends_[0]);
  EXPECT_TRUE(device.measures_turns());
  say_turned({0.8, 0.0, 0.6, 0.0});
  device.open();
  DeviceReading reading;
  say_turned({0.6 * 1.004, 0.0, 0.0, 0.8 * 1.004});
  ASSERT_EQ(device.read(reading), DeviceStatus::kOk);
  EXPECT_EQ(reading.position_m, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_NEAR(reading.turn.z(), 0.8, 1e-12);
  EXPECT_NEAR(reading.turn.w(), 0.6, 1e-12);
}

TEST_F(DriverSocket, ATurnThatIsNoneEndsTheRun) {
  for (const auto& bad :
       {std::array{0.0, 0.0, 0.0, 0.0}, std::array{2.0, 0.0, 0.0, 0.0},
        std::array{1.0, kNan, 0.0, 0.0}}) {
    say(SocketHello{.magic = kTurnedHello, .force_max_n = 5.0});
    SocketDevice device(ends_[0]);
    say_turned({1.0, 0.0, 0.0, 0.0});
    device.open();
    say_turned(bad);
    DeviceReading reading;
    EXPECT_EQ(device.read(reading), DeviceStatus::kLost);
    EXPECT_EQ(device.failure(), "its driver says an orientation that is none");
    device.close();  // zero force is what the driver hears last
    SocketCommand command{.force_n = {1.0, 1.0, 1.0}};
    while (::recv(ends_[1], &command, sizeof command, MSG_DONTWAIT) > 0) {
    }
    EXPECT_EQ(command.force_n, (std::array<double, 3>{}));
    TearDown();
    SetUp();
  }
  ::close(ends_[0]);
}

// Either kind of state belongs to its hello.
TEST_F(DriverSocket, StatesOfTheOtherKindAreRefused) {
  say(SocketHello{.force_max_n = 5.0});
  SocketDevice device(ends_[0]);
  EXPECT_FALSE(device.measures_turns());
  say(SocketState{.time_ns = 1});
  device.open();
  say_turned({1.0, 0.0, 0.0, 0.0});
  DeviceReading reading;
  EXPECT_EQ(device.read(reading), DeviceStatus::kLost);
  EXPECT_NE(device.failure().find("not of the protocol"), std::string::npos);
}

// Turns by 0.01 rad an exchange, from a zero of its own.
class TurningLink : public DeviceLink {
 public:
  [[nodiscard]] std::string name() const override { return "turning"; }
  [[nodiscard]] DeviceLimits limits() const override { return {.force_max_n = 1.0}; }
  void open() override {}
  [[nodiscard]] LinkStatus transact(const Eigen::Vector3d& /*force_n*/,
                                    Eigen::Vector3d& position_m) noexcept override {
    ++exchanges_;
    position_m = {0.01 * (exchanges_ - 1), 0.0, 0.0};
    return LinkStatus::kOk;
  }
  [[nodiscard]] Eigen::Vector3d sent_n() const noexcept override {
    return Eigen::Vector3d::Zero();
  }
  [[nodiscard]] bool measures_turns() const noexcept override { return true; }
  [[nodiscard]] Eigen::Quaterniond turn() const noexcept override {
    return about(Eigen::Vector3d::UnitY(), 0.01 * exchanges_) *
           about(Eigen::Vector3d::UnitX(), 1.0);
  }
  void close() noexcept override {}
  [[nodiscard]] std::string failure() const override { return ""; }

 private:
  int exchanges_ = 0;
};

// With the position that was measured with it.
TEST_F(DriverSocket, ADriverSaysTurnsFromWhereItBegan) {
  std::thread driver([this] {
    TurningLink link;
    EXPECT_EQ(serve_device(link, ends_[1], {}), 0);
  });
  {
    SocketDevice device(ends_[0]);
    device.open();
    DeviceReading reading;
    for (int i = 0; i < 20; ++i) {
      static_cast<void>(device.write(Eigen::Vector3d::Zero()));
      MonotonicClock clock;
      clock.sleep_until_ns(clock.now_ns() + 1'000'000);
      static_cast<void>(device.read(reading));
    }
    EXPECT_GT(reading.position_m.x(), 0.02);
    EXPECT_LT(reading.turn.angularDistance(
                  about(Eigen::Vector3d::UnitY(), reading.position_m.x())),
              1e-7);
  }
  driver.join();
}

}  // namespace
}  // namespace palpate
