// What the fast process makes of a device and of a body that are both made up.
#include "runtime/render/fast_process.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

// 1 N up; whatever a hand puts in, friction takes, and what it gets is in no account.
class RubbedBody : public RenderedBody {
 public:
  bool two = false;  // hands, of which the second feels 2 N up and a torque about x

  [[nodiscard]] std::size_t hands() const noexcept override { return two ? 2 : 1; }
  [[nodiscard]] bool torque_felt() const noexcept override { return two; }
  bool take_in(ArrivalRecord& /*arrival*/) noexcept override { return false; }
  WrenchCommand step(const HandReadings& reading, double /*dt_s*/) noexcept override {
    const double sunk_m = last_m_ - reading[0].position_m.z();
    last_m_ = reading[0].position_m.z();
    rubbed_j_ += std::max(sunk_m, 0.0);
    WrenchCommand command;
    command.wrench[0].force_n = Eigen::Vector3d::UnitZ();
    command.wrench[1] = {2.0 * Eigen::Vector3d::UnitZ(),
                         0.5 * Eigen::Vector3d::UnitX()};
    command.in_contact = true;
    command.dissipated_j = rubbed_j_;
    return command;
  }
  void delivered(const PortWrenches& /*made*/) noexcept override {}
  void raise(Fault fault) noexcept override { fault_ = fault; }
  void publish(const HandReadings& /*reading*/,
               std::int64_t /*ticks*/) noexcept override {}
  [[nodiscard]] Fault fault() const noexcept override { return fault_; }
  [[nodiscard]] bool in_contact() const noexcept override { return true; }
  [[nodiscard]] double work_j() const noexcept override { return rubbed_j_; }
  [[nodiscard]] std::int32_t triangle() const noexcept override { return 0; }
  [[nodiscard]] std::uint64_t dropped() const noexcept override { return 0; }
  void restart() noexcept override {}
  [[nodiscard]] BodyContact contact_at(int /*i*/) const noexcept override { return {}; }
  [[nodiscard]] FastContact contact() const noexcept override { return {}; }
  void accept(const ArrivalRecord& /*arrival*/) override {}
  std::optional<std::size_t> serve(std::int64_t /*now_ns*/) override { return {}; }
  void begin_with(const KeptSurface& /*kept*/) override {}

 private:
  double last_m_ = 0.0;
  double rubbed_j_ = 0.0;
  Fault fault_ = Fault::kNone;
};

// A state each millisecond.
class MovedTool : public Device {
 public:
  [[nodiscard]] std::string name() const override { return "moved tool"; }
  [[nodiscard]] DeviceLimits limits() const override { return {}; }
  void open() override {}
  [[nodiscard]] DeviceStatus read(DeviceReading& reading) noexcept override {
    now_ns_ += 1'000'000;
    if (status == DeviceStatus::kOk) {
      reading.time_ns = now_ns_;
      reading.position_m.z() = height_m;
      reading.turn = Eigen::AngleAxisd(turned_rad, Eigen::Vector3d::UnitX());
    }
    return status;
  }
  [[nodiscard]] DeviceStatus write(const Eigen::Vector3d& force_n) noexcept override {
    written_n = force_n;
    return DeviceStatus::kOk;
  }
  void close() noexcept override {}

  Eigen::Vector3d written_n = Eigen::Vector3d::Zero();
  double height_m = 0.0;
  double turned_rad = 0.0;  // about x
  DeviceStatus status = DeviceStatus::kOk;

 private:
  std::int64_t now_ns_ = 0;
};

// The hand puts in 20 mJ, which friction takes, and is pushed back: each time 0.1 mJ,
// less 5 uJ of damping and 2 uJ of any hand, up to the floor of 10 mJ. A tick later the
// process sees it.
TEST(FastProcess, LendsNothingThatFrictionTook) {
  MovedTool tool;
  RubbedBody body;
  FastProcessConfig config;
  config.rate_hz = 1000.0;
  config.stall_fault_s = 1e9;
  config.wire = {.damping_n_s_per_m = 0.5, .stiffness_n_per_m = 100.0};
  FastProcess process(config, tool, body, {});
  for (int i = 0; i < 200; ++i) {
    tool.height_m -= 1e-4;
    ASSERT_TRUE(process.tick(0));
  }
  EXPECT_NEAR(body.work_j(), 0.02, 1e-12);
  int pushed = 0;
  do {
    tool.height_m += 1e-4;
    ++pushed;
  } while (process.tick(0) && pushed < 1000);
  EXPECT_EQ(body.fault(), Fault::kEnergy);
  EXPECT_EQ(pushed, 109);
}

// What is wrong with either device ends the run of both.
TEST(FastProcess, WatchesEveryHand) {
  for (const std::size_t wrong : {0U, 1U}) {
    for (const Fault fault : {Fault::kDeviceSilent, Fault::kDeviceLost, Fault::kJump}) {
      MovedTool tool[2];
      RubbedBody body;
      body.two = true;
      FastProcessConfig config;
      config.rate_hz = 1000.0;
      config.stall_fault_s = 1e9;
      config.speed_max_m_per_s = 1.0;
      FastProcess process(config, std::array<Device*, 2>{&tool[0], &tool[1]}, body, {});
      for (int i = 0; i < 50; ++i) {
        ASSERT_TRUE(process.tick(0));
      }
      tool[wrong].status = fault == Fault::kDeviceSilent ? DeviceStatus::kLate
                           : fault == Fault::kDeviceLost ? DeviceStatus::kLost
                                                         : DeviceStatus::kOk;
      tool[wrong].height_m = 0.01;
      int ticks = 0;
      while (process.tick(0)) {
        ASSERT_LT(++ticks, 200);
      }
      EXPECT_EQ(process.report().fault, fault);
      EXPECT_EQ(ticks > 50, fault == Fault::kDeviceSilent);
    }
  }
}

// What each hand puts in counts, and what it turns where it feels the torque.
TEST(FastProcess, CountsTheWorkOfEveryHand) {
  MovedTool tool[2];
  RubbedBody body;
  body.two = true;
  FastProcessConfig config;
  config.rate_hz = 1000.0;
  config.stall_fault_s = 1e9;
  FastProcess process(config, std::array<Device*, 2>{&tool[0], &tool[1]}, body, {});
  for (int i = 0; i < 101; ++i) {
    tool[0].height_m -= 1e-4;  // against 1 N
    tool[1].height_m += 1e-4;  // along 2 N
    tool[1].turned_rad = 0.001 * i;
    ASSERT_TRUE(process.tick(0));
  }
  EXPECT_EQ(tool[0].written_n.z(), 1.0);
  EXPECT_EQ(tool[1].written_n.z(), 2.0);
  EXPECT_NEAR(process.report().energy_in_j, 100 * 1e-4 * 1.0, 1e-12);
  EXPECT_NEAR(process.report().energy_out_j, 100 * 1e-4 * 2.0 + 100 * 0.001 * 0.5,
              1e-12);
}

}  // namespace
}  // namespace palpate
