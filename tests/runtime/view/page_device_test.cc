// A page's own device against an emulated service, in simulated time.
#include "runtime/view/page_device.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/padded_plate.h"
#include "tests/support/worn_device.h"

namespace palpate {
namespace {

TEST(PageDevice, IsOffUntilSomebodyAsks) {
  Worn worn(plate_of(100.0));
  worn.pass(0.2);
  EXPECT_EQ(worn.phase(), "off");
  EXPECT_FALSE(worn.page.device().active());
  EXPECT_EQ(worn.service().messages(), 0);
}

TEST(PageDevice, PressesAndGivesTheHandNothing) {
  Worn worn(plate_of(100.0));
  worn.ask();
  worn.pass(0.5);
  EXPECT_EQ(worn.phase(), "testing");
  EXPECT_EQ(worn.service().profile(), "palpate:device");
  worn.pass(kTestedS - 0.5);
  EXPECT_EQ(worn.phase(), "on") << worn.state()["device"];
  EXPECT_NE(worn.detail().find("gravity compensation on"), std::string::npos);
  worn.pass(8.0);  // two rounds of the hand
  EXPECT_EQ(worn.phase(), "on") << worn.state()["device"];
  EXPECT_EQ(worn.state()["fault"], "none");
  EXPECT_EQ(worn.state()["hand_m"], nullptr);
  EXPECT_NEAR(worn.state()["device"]["hz"], 1.0 / 7e-4, 20.0);
  EXPECT_GT(worn.most_n(), 0.15);
  EXPECT_LT(worn.service().given_to_hand_j(), 1e-4);
  EXPECT_EQ(worn.service().refused(), "");
  worn.say(R"({"type":"device","do":"off"})");
  worn.pass(0.1);
  EXPECT_EQ(worn.phase(), "off");
  EXPECT_EQ(worn.service().tool().acting_force_n(), Eigen::Vector3d::Zero());
  // The pointer holds the tool again.
  worn.say(R"({"type":"point","hold":true,"target_m":[0,0,0.004]})");
  worn.pass(0.5);
  EXPECT_EQ(worn.state()["state"], "pressing");
}

// What the hand feels is the body's: at rest the hand's spring bears it.
TEST(PageDevice, RendersTheBodysForceWhereTheToolIs) {
  const ResponseDatabase database = plate_of(100.0, 0.0);
  Worn worn(database);
  worn.ask();
  worn.pass(kTestedS);
  bool pressed = false;
  for (int i = 0; i < 80; ++i) {
    worn.pass(0.05);
    const double depth_m = worn.state()["depth_m"];
    if (depth_m < 1e-4) {
      continue;
    }
    pressed = true;
    const Eigen::Vector3d force_n(worn.state()["force_n"][0],
                                  worn.state()["force_n"][1],
                                  worn.state()["force_n"][2]);
    EXPECT_NEAR(force_n.z(), 100.0 * depth_m, 2e-3);
    // The plate's normal is the device's y.
    EXPECT_NEAR(worn.acting_n().y(), force_n.z(), 0.02);  // an exchange before
  }
  EXPECT_TRUE(pressed);
}

TEST(PageDevice, AServiceOfTheOtherSpellingIsUnderstood) {
  EmulatedInverseConfig old;
  old.version = "3.4.0";
  old.hand.still_s = 6.0;
  Worn worn(plate_of(100.0), old);
  worn.ask();
  worn.pass(11.0);
  EXPECT_EQ(worn.phase(), "on") << worn.state()["device"];
  EXPECT_GT(worn.most_n(), 0.1);
}

EmulatedInverseConfig still_for(double seconds) {
  EmulatedInverseConfig config;
  config.hand.still_s = seconds;
  return config;
}

TEST(PageDevice, AStiffBodyIsRefusedOrSoftenedAndStiffAgainAfterwards) {
  Worn worn(plate_of(2000.0, 0.0), still_for(2.0 * kTestedS));
  worn.ask();
  worn.pass(kTestedS);
  EXPECT_EQ(worn.phase(), "off");
  EXPECT_NE(worn.detail().find("exceeds"), std::string::npos) << worn.detail();
  EXPECT_NE(worn.detail().find("a stiffness of 0.11 or a limit"), std::string::npos);
  worn.ask(true);
  worn.pass(kTestedS);
  ASSERT_EQ(worn.phase(), "on") << worn.detail();
  // b / (T / 2 + T + 1 ms), no fewer than 1 ms held.
  const double renderable = 0.5 / (0.5e-3 + 0.7e-3 + 1e-3);
  EXPECT_NEAR(worn.state()["settings"]["stiffness_scale"], renderable / 2000.0,
              0.02 * renderable / 2000.0);
  worn.pass(8.0);
  EXPECT_EQ(worn.state()["fault"], "none");
  EXPECT_LT(worn.service().given_to_hand_j(), 1e-4);
  worn.say(R"({"type":"set","stiffness_scale":1})");
  worn.pass(0.1);
  EXPECT_NE(worn.refused().find("cannot render"), std::string::npos);
  EXPECT_EQ(worn.phase(), "on");
  worn.say(R"({"type":"device","do":"off"})");
  worn.pass(0.1);
  EXPECT_EQ(worn.state()["settings"]["stiffness_scale"], 1.0);
}

// Slow messages: the same body, half as stiff as what a fast wire renders.
TEST(PageDevice, ASlowWireRendersLess) {
  Worn worn(plate_of(100.0, 0.0));
  worn.way_ns = 4'000'000;
  worn.ask();
  worn.pass(kTestedS);
  EXPECT_EQ(worn.phase(), "off");
  EXPECT_NE(worn.detail().find("held 8 ms"), std::string::npos) << worn.detail();
}

TEST(PageDevice, MessagesThatTakeTooLongAreNotTakenForAToolThatIsHeldFast) {
  EmulatedInverseConfig wanted;
  wanted.faults = {.fault = InverseFault::kMissing, .from = 3, .every = 2};
  Worn worn(plate_of(100.0), wanted);
  worn.ask();
  worn.pass(9.0);
  EXPECT_EQ(worn.phase(), "off");
  EXPECT_NE(worn.detail().find("messages of the device take"), std::string::npos)
      << worn.detail();
}

// One that was fast while its motors were tested.
TEST(PageDevice, AWireThatBecomesSlowInContactIsLetGoOf) {
  Worn worn(plate_of(200.0, 0.0));
  worn.ask();
  worn.pass(kTestedS);
  ASSERT_EQ(worn.phase(), "on") << worn.detail();
  worn.way_ns = 9'000'000;
  worn.pass(8.0);
  EXPECT_EQ(worn.phase(), "off");
  EXPECT_NE(worn.detail().find("let go of after a fault"), std::string::npos)
      << worn.detail();
  EXPECT_LT(worn.service().given_to_hand_j(), 0.012);  // the watch's floor
  EXPECT_EQ(worn.service().tool().acting_force_n(), Eigen::Vector3d::Zero());
}

struct NamedFault {
  InverseFaults faults;
  const char* name;
};

TEST(PageDevice, EveryFaultHasItsNameAndLeavesZeroForce) {
  constexpr std::int64_t kInContact = 6000;  // messages
  const std::vector<NamedFault> all{
      {{.fault = InverseFault::kMissing, .from = kInContact}, "answers no commands"},
      {{.fault = InverseFault::kNotReady, .from = kInContact}, "not ready"},
      {{.fault = InverseFault::kNoPower, .from = kInContact}, "power supply"},
      {{.fault = InverseFault::kNoPosition, .from = kInContact}, "without a position"},
      {{.fault = InverseFault::kUnasked, .from = kInContact}, "nobody asked for"},
      {{.fault = InverseFault::kUnplugged, .from = kInContact}, "unplugged"},
      {{.fault = InverseFault::kSilentUnplug, .from = kInContact}, "unplugged"},
      {{.fault = InverseFault::kNotReady, .from = 0}, "not ready"},
      {{.fault = InverseFault::kEvent,
        .from = kInContact,
        .text = R"({"name":"device-safety-triggered","level":"error","data":)"
                R"({"device_id":"049D","safety_type":"ebrake_triggered"}})"},
       "emergency brake"}};
  for (const NamedFault& fault : all) {
    EmulatedInverseConfig wanted;
    wanted.faults = fault.faults;
    Worn worn(plate_of(100.0), wanted);
    worn.ask();
    worn.pass(5.0);
    EXPECT_EQ(worn.phase(), "off") << fault.name;
    EXPECT_NE(worn.detail().find(fault.name), std::string::npos) << worn.detail();
    EXPECT_EQ(worn.service().tool().acting_force_n(), Eigen::Vector3d::Zero())
        << fault.name;
  }
}

TEST(PageDevice, AStateThatDoesNotComeIsWaitedForAtZeroForce) {
  EmulatedInverseConfig wanted;
  wanted.faults = {.fault = InverseFault::kMissing, .from = 5500, .every = 400};
  Worn worn(plate_of(100.0), wanted);
  worn.ask();
  worn.pass(11.0);
  EXPECT_EQ(worn.phase(), "on") << worn.detail();
  EXPECT_LT(worn.service().given_to_hand_j(), 2e-3);
}

TEST(PageDevice, ALeapOfThePositionIsAFault) {
  Worn worn(plate_of(100.0), still_for(2.0 * kTestedS));
  worn.ask();
  worn.pass(kTestedS);
  ASSERT_EQ(worn.phase(), "on");
  worn.leap_m = 0.02;
  worn.pass(0.2);
  EXPECT_EQ(worn.phase(), "off");
  EXPECT_EQ(worn.state()["fault"], "jump");
  // The run goes on from a reset, and the device may be asked for again.
  worn.leap_m = 0.0;
  worn.ask();
  worn.pass(kTestedS);
  EXPECT_EQ(worn.phase(), "on") << worn.detail();
  EXPECT_EQ(worn.state()["fault"], "none");
}

TEST(PageDevice, APageThatSaysNothingIsLetGoOf) {
  Worn worn(plate_of(100.0));
  worn.ask();
  worn.pass(kTestedS);
  worn.page_speaks = false;
  worn.pass(0.9);
  EXPECT_EQ(worn.phase(), "on");
  worn.pass(0.3);
  EXPECT_EQ(worn.phase(), "off");
  EXPECT_EQ(worn.detail(), "the page fell silent");
}

TEST(PageDevice, ItsRuntimeMayStandStillForATwentiethOfASecond) {
  Worn worn(plate_of(100.0));
  worn.ask();
  worn.pass(kTestedS);
  for (int i = 0; i < 40; ++i) {
    worn.pass(0.2);
    worn.stand_still(0.05);
  }
  worn.pass(0.5);
  EXPECT_EQ(worn.phase(), "on") << worn.detail();
  EXPECT_EQ(worn.state()["fault"], "none");
  EXPECT_LT(worn.service().given_to_hand_j(), 5e-3);
}

// A hand that goes in while the force is withheld gets what it never put in.
TEST(PageDevice, WhatWasWithheldIsInTheAccount) {
  Worn worn(plate_of(200.0, 0.0));
  worn.ask();
  worn.pass(kTestedS);
  double depth_m = 0.0;
  for (int i = 0; i < 600 && worn.phase() == "on"; ++i) {
    const double now_m = worn.state()["depth_m"];
    if (now_m > 1e-4 && now_m > depth_m + 5e-5) {
      worn.stand_still(0.08);
    }
    depth_m = now_m;
    worn.pass(0.02);
  }
  EXPECT_NE(worn.state()["fault"], "none") << worn.detail();
  EXPECT_LT(worn.service().given_to_hand_j(),
            0.013);  // the account's floor, and a press
}

TEST(PageDevice, OneSteersAtATime) {
  Worn worn(plate_of(100.0));
  worn.ask();
  worn.pass(kTestedS);
  for (const char* message :
       {R"({"type":"point","hold":true,"target_m":[0,0,0.01]})",
        R"({"type":"run","do":"pause"})", R"({"type":"run","do":"step"})",
        R"({"type":"run","do":"record"})", R"({"type":"run","do":"replay"})",
        R"({"type":"set","model":"element"})", R"({"type":"set","friction":0.1})",
        R"({"type":"device","do":"on","node":60,"right":[1,0,0],"limit":true})"}) {
    worn.say(R"({"type":"node","node":99999})");
    worn.pass(0.05);
    EXPECT_NE(worn.refused().find("99999"), std::string::npos);
    worn.say(message);
    worn.pass(0.05);
    EXPECT_EQ(worn.refused().find("99999"), std::string::npos) << message;
    EXPECT_EQ(worn.phase(), "on") << message;
  }
  worn.say(R"({"type":"set","slow_hz":50,"stiffness_scale":0.5})");
  worn.pass(0.1);
  EXPECT_EQ(worn.state()["settings"]["stiffness_scale"], 0.5);
  worn.say(R"({"type":"run","do":"reset"})");
  worn.pass(0.1);
  EXPECT_EQ(worn.phase(), "on");
}

TEST(PageDevice, IsNotForSeveralContactsNorForModelsThatPush) {
  Worn worn(plate_of(100.0));
  worn.say(R"({"type":"set","model":"single"})");
  worn.ask();
  worn.pass(0.1);
  EXPECT_NE(worn.refused().find("push a hand"), std::string::npos);
  PageBody pads(padded_plate(3), "pads.h5", {.tools = {"pads"}});
  EXPECT_THROW(pads.device().ask({.node = 0, .right = Eigen::Vector3d::UnitX()}),
               InputError);
}

TEST(PageDevice, ServicesThatAreNotThereAreSaidSo) {
  PageBody page(plate_of(100.0), "plate.h5", {});
  page.receive(
      R"({"type":"device","do":"on","node":60,"right":[1,0,0],"limit":false})");
  ASSERT_TRUE(page.device().active());
  for (int i = 0; i < 400; ++i) {
    page.receive(R"({"type":"device","do":"keep"})");
    page.frame(kDrawNs * (i + 1));
  }
  EXPECT_FALSE(page.device().active());
  EXPECT_NE(page.device().shown().detail.find("port 10001 within 5 s"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate
