// Motors that push the wrong way are found with 0.3 N, before anything is rendered.
#include "runtime/attach/sign_test.h"

#include <memory>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/emulation/emulated_haply.h"
#include "tests/support/held_falcon.h"

namespace palpate {
namespace {

// Of a hand with spring, damper and mass, whose motors may be reversed along an axis.
class HeldTool : public DeviceLink {
 public:
  explicit HeldTool(Clock& time) : clock_(time) {}
  Eigen::Vector3d gain = Eigen::Vector3d::Ones();
  double hand_n_per_m = 300.0;
  double hand_n_s_per_m = 3.0;
  Eigen::Vector3d pull_n = Eigen::Vector3d::Zero();
  double largest_n = 0.0;
  std::int64_t exchange_ns = 500'000;
  bool open_now = false;

  [[nodiscard]] std::string name() const override { return "held"; }
  [[nodiscard]] DeviceLimits limits() const override { return {}; }
  void open() override { open_now = true; }
  // As long as the clock says that it took, in steps of 0.1 ms.
  [[nodiscard]] LinkStatus transact(const Eigen::Vector3d& force_n,
                                    Eigen::Vector3d& position_m) noexcept override {
    constexpr double kMassKg = 0.2;
    constexpr std::int64_t kStepNs = 100'000;
    largest_n = std::max(largest_n, force_n.norm());
    const std::int64_t now_ns = clock_.now_ns();
    for (; begun_ && time_ns_ + kStepNs <= now_ns; time_ns_ += kStepNs) {
      const Eigen::Vector3d f = gain.cwiseProduct(sent_n_) + pull_n -
                                hand_n_per_m * x_m_ - hand_n_s_per_m * v_;
      v_ += 1e-4 / kMassKg * f;
      x_m_ += 1e-4 * v_;
    }
    time_ns_ = begun_ ? time_ns_ : now_ns;
    begun_ = true;
    sent_n_ = force_n;
    position_m = 5e-5 * (x_m_ / 5e-5).array().round();
    clock_.sleep_until_ns(now_ns + exchange_ns);
    return LinkStatus::kOk;
  }
  [[nodiscard]] Eigen::Vector3d sent_n() const noexcept override { return sent_n_; }
  void close() noexcept override { open_now = false; }
  [[nodiscard]] std::string failure() const override { return ""; }

 private:
  Clock& clock_;
  bool begun_ = false;
  std::int64_t time_ns_ = 0;
  Eigen::Vector3d sent_n_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d x_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_ = Eigen::Vector3d::Zero();
};

std::string refusal(DeviceLink& link, Clock& clock,
                    const SignTestOptions& options = {}) {
  try {
    (void)test_signs(link, options, {}, clock);
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "";
}

TEST(SignTest, AHandThatHoldsIsPushedAndTakesTheWork) {
  SimulatedClock clock;
  HeldTool tool(clock);
  const SignWork work_j = test_signs(tool, {}, {}, clock);
  for (const double axis_j : work_j) {
    EXPECT_GT(axis_j, 1e-4);
  }
  EXPECT_LE(tool.largest_n, 0.3 + 1e-12);
  EXPECT_EQ(tool.sent_n().norm(), 0.0);
}

// The tool moves under the force of the exchange before, not under the one that its
// position answers.
TEST(SignTest, ALinkThatTakesItsTimeDoesNotTurnTheSign) {
  for (const std::int64_t exchange_ns : {5'000'000, 20'000'000, 40'000'000}) {
    for (const double gain : {1.0, -1.0}) {
      SimulatedClock clock;
      HeldTool tool(clock);
      tool.exchange_ns = exchange_ns;
      tool.gain.setConstant(gain);
      const std::string why = refusal(tool, clock);
      EXPECT_EQ(why.find("wrong way along x") != std::string::npos, gain < 0.0) << why;
      EXPECT_EQ(why.empty(), gain > 0.0) << why;
    }
  }
}

TEST(SignTest, AnAxisThatPushesTheWrongWayIsNamed) {
  for (const int axis : {0, 1, 2}) {
    SimulatedClock clock;
    HeldTool tool(clock);
    tool.gain[axis] = -1.0;
    const std::string why = refusal(tool, clock);
    EXPECT_NE(why.find(std::string("wrong way along ") + "xyz"[axis]),
              std::string::npos)
        << why;
    EXPECT_LE(tool.largest_n, 0.3 + 1e-12);
    EXPECT_EQ(tool.sent_n().norm(), 0.0);
  }
}

TEST(SignTest, AToolThatRunsAwayIsLetGo) {
  SimulatedClock clock;
  HeldTool tool(clock);
  tool.hand_n_per_m = 0.0;
  tool.hand_n_s_per_m = 0.5;
  tool.pull_n.y() = -1.0;  // nobody holds it: it falls
  const std::string why = refusal(tool, clock);
  EXPECT_NE(why.find("ran away"), std::string::npos) << why;
  EXPECT_EQ(tool.sent_n().norm(), 0.0);
}

TEST(SignTest, AToolThatCannotMoveIsNotTakenForRight) {
  SimulatedClock clock;
  HeldTool tool(clock);
  tool.gain.setZero();  // without its mains adapter
  const std::string why = refusal(tool, clock, {.rounds = 1});
  EXPECT_NE(why.find("moved nothing"), std::string::npos) << why;
}

TEST(SignTest, IsInterrupted) {
  SimulatedClock clock;
  HeldTool tool(clock);
  int looks = 0;
  EXPECT_THROW((void)test_signs(
                   tool, {},
                   [&] {
                     return ++looks > 20;
                   },
                   clock),
               Interrupted);
  EXPECT_EQ(tool.sent_n().norm(), 0.0);
}

TEST(SignTest, OfALinkIsMadeAtEveryOpenAndClosesIt) {
  MonotonicClock clock;
  auto tool = std::make_unique<HeldTool>(clock);
  HeldTool& held = *tool;
  std::string told;
  SignTestedLink link(std::move(tool), {.axes = 1, .rounds = 1},
                      [&](const std::string& text) {
                        told += text;
                      },
                      {});
  link.open();
  EXPECT_TRUE(held.open_now);
  EXPECT_NE(told.find("hold the tool loosely"), std::string::npos);
  held.gain.x() = -1.0;
  EXPECT_THROW(link.open(), DeviceError);
  EXPECT_FALSE(held.open_now);
}

// The emulated devices, whole: board, wire, libusb, driver.
TEST(SignTest, AFalconWithReversedMotorsIsNotDriven) {
  for (const double calibration : {1.0, -1.0}) {
    FalconConfig config = patient_driver();
    config.calibration = calibration;
    EmulatedFalconConfig held = held_loaded_falcon();
    held.model.hand.clear_m = 1e-9;
    held.model.hand.circle_m = 0.0;
    const auto falcon = std::make_shared<EmulatedFalcon>(held);
    const auto link = EmulatedFalcon::link(falcon, config);
    link->open();
    MonotonicClock clock;
    const std::string why =
        refusal(*link, clock, {.rounds = calibration > 0.0 ? 3 : 1});
    EXPECT_EQ(why.empty(), calibration > 0.0) << why;
    link->close();
  }
}

}  // namespace
}  // namespace palpate
