// The protocol without sockets, against the service without sockets.
#include "runtime/inverse/inverse_session.h"

#include <gtest/gtest.h>

#include "runtime/inverse/inverse_emulation.h"
#include "tests/runtime/inverse/free_tool.h"

namespace palpate {
namespace {

TEST(InverseSession, PushesFromTheThirdCommandOnAndNotAfterAMiss) {
  SimulatedClock clock;
  InverseEmulation service(free_tool_config(), clock, {});
  InverseSession session(InverseConfig{});
  session.greet(service.first_message(), "vector");
  const auto exchange = [&](bool in_time) {
    service.obey(std::string(session.command(kPush, "p")));
    EXPECT_EQ(session.sent_n(), service.tool().acting_force_n());
    EXPECT_EQ(session.take(service.answer()), nullptr);
    EXPECT_EQ(session.exchanged(in_time), nullptr);
    return session.sent_n();
  };
  EXPECT_EQ(exchange(true), Eigen::Vector3d::Zero());
  EXPECT_EQ(exchange(true), Eigen::Vector3d::Zero());
  EXPECT_EQ(exchange(true), kPush);
  EXPECT_EQ(exchange(false), kPush);
  EXPECT_TRUE(session.missing());
  EXPECT_EQ(exchange(true), Eigen::Vector3d::Zero());
  EXPECT_EQ(exchange(true), kPush);
  EXPECT_EQ(service.refused(), "");
  EXPECT_EQ(service.profile(), "p");
}

TEST(InverseSession, ThreeStatesTooManyAreBorne) {
  SimulatedClock clock;
  InverseEmulation service(free_tool_config(), clock, {});
  InverseSession session(InverseConfig{});
  session.greet(service.first_message(), "vector");
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(session.take(service.answer()), nullptr);
  }
  EXPECT_STREQ(session.take(service.answer()), "sends states that nobody asked for");
}

}  // namespace
}  // namespace palpate
