// The client against an emulated service that does everything wrong: every fault has a
// name, and the tool is at zero force after the next message.
#include "runtime/inverse/inverse_link.h"

#include <array>
#include <chrono>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/inverse/emulated_inverse.h"
#include "tests/runtime/inverse/free_tool.h"
#include "tests/support/allocation_guard.h"

namespace palpate {
namespace {

InverseConfig client_config(const EmulatedInverse& service) {
  InverseConfig config;
  config.port = service.port();
  config.events_port = service.events_port();
  return config;
}

// Pushes until the link is lost, at the rate of a fast loop. @returns exchanges.
int push_until_lost(InverseLink& link, int most = 1000) {
  Eigen::Vector3d position_m;
  int exchanges = 1;
  while (link.transact(kPush, position_m) != LinkStatus::kLost && exchanges < most) {
    ++exchanges;
    std::this_thread::sleep_for(std::chrono::microseconds(250));
  }
  return exchanges;
}

std::string opening_error(const EmulatedInverseConfig& wanted,
                          const std::string& id = "") {
  EmulatedInverse service(wanted);
  InverseConfig config = client_config(service);
  config.device_id = id;
  config.open_s = 0.5;
  InverseLink link(config);
  try {
    link.open();
  } catch (const DeviceError& error) {
    EXPECT_EQ(service.force_n(), Eigen::Vector3d::Zero());
    return error.what();
  }
  return "";
}

TEST(InverseLink, RendersForcesInBothSpellingsInOurAxes) {
  for (const char* version : {"3.5.1", "3.1.1"}) {
    EmulatedInverseConfig wanted = free_tool_config();
    wanted.version = version;
    EmulatedInverse service(wanted);
    InverseLink link(client_config(service));
    link.open();
    EXPECT_EQ(service.profile(), "palpate:device");
    Eigen::Vector3d position_m;
    ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kOk);  // known from here
    EXPECT_NEAR((position_m - inverse_rest_m()).norm(), 0.0, 1e-3);
    ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kOk);
    EXPECT_EQ(service.force_n(), kPush);
    EXPECT_EQ(link.sent_n(), kPush);
    EXPECT_EQ(service.refused(), "");
    for (int i = 0; i < 200; ++i) {
      ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kOk);
    }
    // It went where it was pushed.
    EXPECT_GT((position_m - inverse_rest_m()).dot(kPush), 0.0);
    ASSERT_EQ(link.transact(100.0 * kPush, position_m), LinkStatus::kOk);
    EXPECT_NEAR(service.force_n().norm(), 5.0, 1e-6);
    link.close();
    EXPECT_EQ(service.force_n(), Eigen::Vector3d::Zero());
  }
}

TEST(InverseLink, SaysWhatAltersWhatIsFelt) {
  EmulatedInverse service(free_tool_config());
  InverseConfig config = client_config(service);
  std::string told;
  config.tell = [&told](const std::string& text) {
    told += text;
  };
  InverseLink(config).open();
  EXPECT_NE(told.find("gravity compensation on, force gate with gain 0.3"),
            std::string::npos)
      << told;
  EXPECT_EQ(told.find("damping"), std::string::npos) << told;
}

TEST(InverseLink, ExchangesWithoutAllocation) {
  EmulatedInverse service(free_tool_config());
  InverseLink link(client_config(service));
  link.open();
  Eigen::Vector3d position_m;
  ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kOk);
  const test::AllocationGuard guard;  // of this thread
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kOk);
  }
  EXPECT_EQ(guard.count(), 0U);
}

TEST(InverseLink, OpensOnlyWhatIsThereAndFree) {
  EmulatedInverseConfig wanted = free_tool_config();
  wanted.version = "2.1.0";
  EXPECT_NE(opening_error(wanted).find("version of the service is 2.1"),
            std::string::npos);
  wanted = free_tool_config();
  wanted.in_use = true;
  EXPECT_NE(opening_error(wanted).find("in use by another session"), std::string::npos);
  wanted = free_tool_config();
  wanted.devices = 0;
  EXPECT_NE(opening_error(wanted).find("plugged in?"), std::string::npos);
  wanted.devices = 2;
  EXPECT_NE(opening_error(wanted).find("--device-id"), std::string::npos);
  EXPECT_EQ(opening_error(wanted, "049D"), "");
  EXPECT_NE(opening_error(wanted, "XX").find("no device XX"), std::string::npos);
  wanted = free_tool_config();
  wanted.faults = {.fault = InverseFault::kNotReady, .from = 0};
  EXPECT_NE(opening_error(wanted).find("not ready"), std::string::npos);
  wanted.faults = {.fault = InverseFault::kNoPower, .from = 0};
  EXPECT_NE(opening_error(wanted).find("power supply"), std::string::npos);
  InverseConfig nowhere;
  nowhere.port = 1;
  InverseLink link(nowhere);
  EXPECT_THROW(link.open(), DeviceError);
  InverseConfig evil;
  evil.profile = "a\"}";
  EXPECT_THROW(InverseLink{evil}, InputError);
}

struct NamedFault {
  InverseFaults faults;
  const char* name;
};

TEST(InverseLink, EveryFaultHasItsNameAndLeavesZeroForceAtOnce) {
  const auto event = [](const std::string& name, const std::string& type) {
    return R"({"name":")" + name +
           R"(","level":"error","data":{"device_id":"049D","safety_type":")" + type +
           R"("}})";
  };
  const auto say = [](const std::string& text) {
    return InverseFaults{.fault = InverseFault::kText, .from = 20, .text = text};
  };
  const std::vector<NamedFault> faults = {
      {{.fault = InverseFault::kNotReady, .from = 20}, "not ready"},
      {{.fault = InverseFault::kNotCalibrated, .from = 20}, "not calibrated"},
      {{.fault = InverseFault::kNoPower, .from = 20}, "power supply"},
      {{.fault = InverseFault::kNoPosition, .from = 20}, "without a position"},
      {{.fault = InverseFault::kNoTurn, .from = 20}, "orientation that is none"},
      {{.fault = InverseFault::kUnplugged, .from = 20}, "unplugged"},
      {{.fault = InverseFault::kSilentUnplug, .from = 20}, "unplugged"},
      {{.fault = InverseFault::kUnasked, .from = 20}, "nobody asked for"},
      {{.fault = InverseFault::kClosed, .from = 20}, "closed the session"},
      {{.fault = InverseFault::kCutFrame, .from = 20}, "connection broke"},
      {{.fault = InverseFault::kMissing, .from = 20}, "answers no commands"},
      {{.fault = InverseFault::kEvent,
        .from = 20,
        .text = event("device-safety-triggered", "ebrake_triggered")},
       "emergency brake"},
      {{.fault = InverseFault::kEvent, .from = 20, .text = event("device-busy", "")},
       "busy"},
      {{.fault = InverseFault::kEvent, .from = 20, .text = "{"}, "string should be"},
      {say("{}"), "unplugged"},
      {say("[1"), "object should be"},
      {say("{\"a\":" + std::string(60000, '[')), "more than 32 levels"},
      {say("{\"a\":\"" + std::string(70000, 'a') + "\"}"), "too long"},
      {say(R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":)"
           R"({"x":1e999,"y":0,"z":0}}}]})"),
       "number should be"},
  };
  for (const NamedFault& fault : faults) {
    EmulatedInverseConfig wanted = free_tool_config();
    wanted.faults = fault.faults;
    wanted.idle_ns = 60'000'000'000;  // forces stay: the client has to end them
    EmulatedInverse service(wanted);
    InverseLink link(client_config(service));
    link.open();
    EXPECT_LT(push_until_lost(link), 100) << fault.name;
    EXPECT_NE(link.failure().find(fault.name), std::string::npos) << link.failure();
    EXPECT_EQ(link.sent_n(), Eigen::Vector3d::Zero());
    // Without close(): the last message, or the end of the session.
    EXPECT_TRUE(becomes([&] {
      return service.force_n() == Eigen::Vector3d::Zero();
    })) << fault.name;
    EXPECT_GE(service.messages(), 19) << fault.name;  // it was pushed before
    Eigen::Vector3d position_m;
    EXPECT_EQ(link.transact(kPush, position_m), LinkStatus::kLost);  // for good
  }
}

// Whoever is not heard of for a while is asleep; for longer, gone.
TEST(InverseLink, AGripThatIsGoneIsAFaultAfterAWhile) {
  EmulatedInverseConfig wanted = free_tool_config();
  wanted.grip_turn = [](double time_s) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(time_s, Eigen::Vector3d::UnitY()));
  };
  for (const std::int64_t count : {InverseSession::kGripSilentMax - 1, 1000}) {
    wanted.faults = {.fault = InverseFault::kNoGrip, .from = 20, .count = count};
    EmulatedInverse service(wanted);
    InverseLink link(client_config(service));
    link.open();
    ASSERT_TRUE(link.measures_turns());
    const Eigen::Quaterniond before = link.turn();
    const bool goes_on = count < InverseSession::kGripSilentMax;
    const int exchanges = push_until_lost(link, 200);
    EXPECT_EQ(exchanges < 200, !goes_on);
    if (goes_on) {
      // About our y axis, whatever the grip's own zero is.
      const Eigen::Vector3d axis = (link.turn() * before.conjugate()).vec();
      EXPECT_GT(axis.y(), 1e-4);
      EXPECT_LT((axis - axis.y() * Eigen::Vector3d::UnitY()).norm(), 1e-6);
    } else {
      EXPECT_NE(link.failure().find("grip is gone"), std::string::npos);
      EXPECT_NEAR(exchanges, 18 + InverseSession::kGripSilentMax, 1);
    }
  }
}

TEST(InverseLink, ChoosesAGripOrSaysWhyNot) {
  EmulatedInverseConfig wanted = free_tool_config();
  const auto open = [&wanted](const std::string& grip) {
    EmulatedInverse service(wanted);
    InverseConfig config = client_config(service);
    config.grip_id = grip;
    std::string told;
    config.tell = [&told](const std::string& text) {
      told += text + "\n";
    };
    InverseLink link(config);
    link.open();
    return std::pair(link.measures_turns(), told);
  };
  EXPECT_NE(open("").second.find("grip 61576 turns"), std::string::npos);
  wanted.grips = 2;
  const auto [turned, told] = open("");
  EXPECT_FALSE(turned);
  EXPECT_NE(told.find("2 grips, none of them turns the tool"), std::string::npos);
  EXPECT_TRUE(open("61577").first);
  EXPECT_THROW(static_cast<void>(open("1")), DeviceError);
  wanted.grips = 0;
  EXPECT_FALSE(open("").first);
  wanted.grips = 1;
  wanted.faults = {.fault = InverseFault::kNoTurn, .from = 0};
  EXPECT_FALSE(open("").first);  // asleep when it began
}

// A tool pushed along x moves on; a position that answers an older message lies behind.
TEST(InverseLink, ALateAnswerTakesTheForceAwayAndIsPassedOver) {
  EmulatedInverseConfig wanted = free_tool_config();
  wanted.faults = {
      .fault = InverseFault::kLate, .from = 50, .count = 1, .late_ns = 60'000'000};
  EmulatedInverse service(wanted);
  InverseLink link(client_config(service));
  link.open();
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  LinkStatus status = LinkStatus::kOk;
  while (service.messages() < 49) {
    ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kOk);
  }
  const Eigen::Vector3d before_m = position_m;
  ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kMissed);
  int missed = 1;
  while ((status = link.transact(kPush, position_m)) == LinkStatus::kMissed) {
    EXPECT_EQ(link.sent_n(), Eigen::Vector3d::Zero());
    EXPECT_EQ(service.force_n(), Eigen::Vector3d::Zero());  // the next message
    ++missed;
  }
  EXPECT_EQ(status, LinkStatus::kOk);
  EXPECT_GE(missed, 2);
  // From here on each answer is that of its own command: a push is felt at once.
  ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kOk);
  EXPECT_EQ(service.force_n(), kPush);
  EXPECT_GT((position_m - before_m).dot(kPush), 0.0);
}

TEST(InverseLink, AMissingAnswerIsGotOver) {
  EmulatedInverseConfig wanted = free_tool_config();
  wanted.faults = {.fault = InverseFault::kMissing, .from = 30, .count = 2};
  EmulatedInverse service(wanted);
  InverseLink link(client_config(service));
  link.open();
  Eigen::Vector3d position_m;
  int missed = 0;
  for (int i = 0; i < 100; ++i) {
    const LinkStatus status = link.transact(kPush, position_m);
    ASSERT_NE(status, LinkStatus::kLost);
    missed += status == LinkStatus::kMissed ? 1 : 0;
  }
  EXPECT_EQ(missed, 2);
}

TEST(InverseLink, ForceEndsWithAClientThatFallsSilent) {
  EmulatedInverse service(free_tool_config());
  InverseLink link(client_config(service));
  link.open();
  Eigen::Vector3d position_m;
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(link.transact(kPush, position_m), LinkStatus::kOk);
  }
  ASSERT_EQ(service.force_n(), kPush);
  EXPECT_TRUE(becomes([&] {
    return service.force_n() == Eigen::Vector3d::Zero();
  }));
}

TEST(InverseLink, OpensAgainAfterTheServiceHasRestarted) {
  EmulatedInverseConfig wanted = free_tool_config();
  auto service = std::make_unique<EmulatedInverse>(wanted);
  wanted.port = service->port();
  wanted.events_port = service->events_port();
  InverseLink link(client_config(*service));
  link.open();
  service.reset();
  EXPECT_LT(push_until_lost(link), 100);
  EXPECT_NE(link.failure().find("the service has stopped"), std::string::npos)
      << link.failure();
  EXPECT_THROW(link.open(), DeviceError);
  service = std::make_unique<EmulatedInverse>(wanted);
  link.open();
  Eigen::Vector3d position_m;
  EXPECT_EQ(link.transact(kPush, position_m), LinkStatus::kOk);
}

// Unplugged, cut in the middle of a frame, closed, without a word or with: 200 times.
TEST(InverseLink, UnpluggedAtAnyFrameLeavesZeroForce) {
  std::mt19937 random(27);
  std::uniform_int_distribution<std::int64_t> frame(2, 40);
  constexpr std::array kWays{InverseFault::kUnplugged, InverseFault::kSilentUnplug,
                             InverseFault::kCutFrame, InverseFault::kClosed};
  for (int i = 0; i < 200; ++i) {
    EmulatedInverseConfig wanted = free_tool_config();
    wanted.idle_ns = 60'000'000'000;
    wanted.faults = {.fault = kWays[static_cast<std::size_t>(i) % kWays.size()],
                     .from = frame(random)};
    EmulatedInverse service(wanted);
    InverseLink link(client_config(service));
    link.open();
    // The frame itself, or the one after: an event has a socket of its own.
    EXPECT_LE(push_until_lost(link), wanted.faults.from + 1);
    EXPECT_NE(link.failure(), "");
    EXPECT_TRUE(becomes([&] {
      return service.force_n() == Eigen::Vector3d::Zero();
    }));
    ASSERT_LE(service.messages(), wanted.faults.from + 1);  // and zero, the last one
  }
}

}  // namespace
}  // namespace palpate
