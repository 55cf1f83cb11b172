// What a driver says over its socket: positions, orientations, its end.
#include "runtime/device/socket_device.h"

#include <array>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "runtime/device/device_driver.h"
#include "runtime/realtime/clock.h"
#include "tests/runtime/device/turns.h"

namespace palpate {
namespace {

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

// Killed, unplugged or out of its mind, at any datagram.
TEST_F(DriverSocket, ADriverThatEndsAtAnyDatagramIsALossWithAName) {
  std::mt19937 random(27);
  std::uniform_int_distribution<int> many(1, 30);
  for (int i = 0; i < 200; ++i) {
    const int last = many(random);
    say(SocketHello{.force_max_n = 5.0});
    SocketDevice device(ends_[0]);
    say(SocketState{.time_ns = 1});
    device.open();
    DeviceReading reading;
    DeviceStatus status = DeviceStatus::kOk;
    for (int k = 0; k < last + 2 && status != DeviceStatus::kLost; ++k) {
      if (k < last) {
        say(SocketState{.time_ns = k + 2});
      } else if (k == last && i % 2 == 0) {
        say(std::array<char, 33>{});
      } else if (k == last) {
        ::shutdown(ends_[1], SHUT_RDWR);  // the guardian has it open, too
      }
      status = device.read(reading);
      if (status != DeviceStatus::kLost) {
        status = device.write({0.1, 0.0, 0.0});
      }
    }
    EXPECT_EQ(status, DeviceStatus::kLost);
    EXPECT_EQ(device.failure(), i % 2 == 0
                                    ? "its driver says what is not of the protocol"
                                    : "its driver has ended without a word");
    device.close();
    TearDown();
    SetUp();
  }
  ::close(ends_[0]);
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
