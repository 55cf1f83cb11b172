// Force after a fault: the commands that the emulated Falcon took, with their times.
#include <chrono>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/held_falcon.h"

namespace palpate {
namespace {

constexpr std::int64_t kWrongFrom = 100;  // command whose reply is the first wrong one

EmulatedFalconConfig traced() {
  EmulatedFalconConfig config = held_loaded_falcon();
  config.model.trace_max = 100'000;
  return config;
}

bool driven(const MotorRecord& record) {
  return record.force_n > 0.0;
}

struct Outcome {
  int unanswered = 0;         // exchanges
  int driven_unanswered = 0;  // commands with force right after one
  bool lost = false;
  std::string failure;
  std::vector<MotorRecord> trace;
};

// Pushes with 1 N until the end or the loss; then leaves as every way out does.
Outcome push(const EmulatedFalconConfig& config, int exchanges) {
  const auto falcon = std::make_shared<EmulatedFalcon>(config);
  const auto link = EmulatedFalcon::link(falcon, patient_driver());
  link->open();
  Outcome outcome;
  LinkStatus before = LinkStatus::kOk;
  for (int i = 0; i < exchanges && !outcome.lost; ++i) {
    Eigen::Vector3d position;
    const auto commands = [&] {
      return falcon->usb().locked([&] {
        return falcon->model().trace().size();
      });
    };
    const std::size_t taken = commands();
    const LinkStatus status = link->transact({0.0, 0.0, 1.0}, position);
    const bool force = commands() > taken && falcon->usb().locked([&] {
      return driven(falcon->model().trace().back());
    });
    outcome.driven_unanswered += before == LinkStatus::kMissed && force ? 1 : 0;
    outcome.unanswered += status == LinkStatus::kMissed ? 1 : 0;
    outcome.lost = status == LinkStatus::kLost;
    before = status;
  }
  outcome.failure = link->failure();
  link->close();
  EXPECT_EQ(falcon->model().command().leds, 0);
  EXPECT_TRUE(falcon->kernel_driver_back());
  EXPECT_FALSE(driven(falcon->model().trace().back()));
  outcome.trace = falcon->model().trace();
  return outcome;
}

class FalconReplyFault : public testing::TestWithParam<ReplyFault> {};

// The command whose reply is wrong is the first period, the one after it is the second.
TEST_P(FalconReplyFault, PutsTheForceToZeroWithTheNextCommandAndNotForGood) {
  EmulatedFalconConfig config = traced();
  config.model.wrong = {.fault = GetParam(), .from = kWrongFrom, .count = 5};
  const Outcome outcome = push(config, 400);
  const auto wrong = static_cast<std::size_t>(kWrongFrom - 1);
  ASSERT_GT(outcome.trace.size(), wrong + 1);
  EXPECT_TRUE(driven(outcome.trace[wrong]));
  EXPECT_FALSE(driven(outcome.trace[wrong + 1]));
  RecordProperty(
      "microseconds_to_zero",
      static_cast<int>(
          (outcome.trace[wrong + 1].time_ns - outcome.trace[wrong].time_ns) / 1000));
  EXPECT_EQ(outcome.driven_unanswered, 0);
  if (GetParam() == ReplyFault::kStale) {  // from before homing
    EXPECT_TRUE(outcome.lost);
    EXPECT_EQ(outcome.failure, "it forgot its zero; home it again");
  } else {
    EXPECT_FALSE(outcome.lost) << outcome.failure;
    EXPECT_GE(outcome.unanswered, 5);
    EXPECT_TRUE(driven(outcome.trace[outcome.trace.size() - 20]));
  }
}

INSTANTIATE_TEST_SUITE_P(All, FalconReplyFault,
                         testing::Values(ReplyFault::kMissing, ReplyFault::kGarbage,
                                         ReplyFault::kStale, ReplyFault::kJump));

TEST(FalconZeroForce, AReplyIsWaitedForTwoPeriodsAtMost) {
  EXPECT_LE(FalconConfig{}.answer_s, 2e-3);
}

TEST(FalconZeroForce, LegsThatJumpForGoodAreALossWithZeroForce) {
  EmulatedFalconConfig config = traced();
  config.model.wrong = {
      .fault = ReplyFault::kJump, .from = kWrongFrom, .count = 100'000};
  const Outcome outcome = push(config, 400);
  EXPECT_TRUE(outcome.lost);
  EXPECT_EQ(outcome.failure, "its encoders jump");
}

TEST(FalconZeroForce, AfterASilenceOfTheWireTheFirstCommandIsZero) {
  EmulatedFalconConfig config = traced();
  config.bus.silent_from_byte = 5000;
  config.bus.silent_bytes = 160;
  const Outcome outcome = push(config, 400);
  EXPECT_FALSE(outcome.lost);
  EXPECT_GE(outcome.unanswered, 5);
  EXPECT_EQ(outcome.driven_unanswered, 0);
  std::size_t back = 1;  // the first command after the longest pause
  for (std::size_t i = 1; i < outcome.trace.size(); ++i) {
    const auto pause_ns = [&](std::size_t at) {
      return outcome.trace[at].time_ns - outcome.trace[at - 1].time_ns;
    };
    back = pause_ns(i) > pause_ns(back) ? i : back;
  }
  EXPECT_TRUE(driven(outcome.trace[back - 1]));
  EXPECT_FALSE(driven(outcome.trace[back]));
  EXPECT_TRUE(driven(outcome.trace[outcome.trace.size() - 20]));
}

TEST(FalconZeroForce, AfterAStallNoUnansweredExchangeIsFollowedByForce) {
  for (const std::int64_t byte : {5000, 5008, 5016, 5024}) {
    EmulatedFalconConfig config = traced();
    config.bus.stall_at_byte = byte;
    const Outcome outcome = push(config, 300);
    EXPECT_FALSE(outcome.lost);
    EXPECT_EQ(outcome.driven_unanswered, 0);
    EXPECT_TRUE(driven(outcome.trace[outcome.trace.size() - 20]));
  }
}

// The thread that speaks to the device takes the force away when the session ends.
TEST(FalconZeroForce, AnExceptionInTheLoopLeavesNoForceNoLightAndTheKernelsDriver) {
  const auto falcon = std::make_shared<EmulatedFalcon>(traced());
  LinkedDevice device(EmulatedFalcon::link(falcon, patient_driver()), {});
  const auto loop = [&] {
    const DeviceSession session(device);
    for (int i = 0; i < 20'000; ++i) {
      DeviceReading reading;
      static_cast<void>(device.read(reading));
      static_cast<void>(device.write({0.0, 0.0, 1.0}));
      const bool force = falcon->usb().locked([&] {
        return driven(falcon->model().trace().back());
      });
      if (force) {
        throw std::runtime_error("the loop's");
      }
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  };
  EXPECT_THROW(loop(), std::runtime_error);
  EXPECT_FALSE(driven(falcon->model().trace().back()));
  EXPECT_EQ(falcon->model().command().leds, 0);
  EXPECT_TRUE(falcon->kernel_driver_back());
}

TEST(FalconZeroForce, ADriverThatCouldNotHomeOrWasDroppedLeavesTheDeviceAsItWas) {
  EmulatedFalconConfig config = traced();
  config.model.homing_ns = -1;
  FalconConfig quick = patient_driver();
  quick.homing_s = 0.05;
  const auto unhomed = std::make_shared<EmulatedFalcon>(config);
  EXPECT_THROW(EmulatedFalcon::link(unhomed, quick)->open(), DeviceError);
  EXPECT_EQ(unhomed->model().command().leds, 0);
  EXPECT_TRUE(unhomed->kernel_driver_back());

  const auto falcon = std::make_shared<EmulatedFalcon>(traced());
  {
    const auto link = EmulatedFalcon::link(falcon, patient_driver());
    link->open();
    Eigen::Vector3d position;
    for (int i = 0; i < 5; ++i) {
      static_cast<void>(link->transact({0.0, 0.0, 1.0}, position));
    }
    EXPECT_FALSE(falcon->usb().kernel_driver());
  }
  EXPECT_FALSE(driven(falcon->model().trace().back()));
  EXPECT_EQ(falcon->model().command().leds, 0);
  EXPECT_TRUE(falcon->kernel_driver_back());
}

}  // namespace
}  // namespace palpate
