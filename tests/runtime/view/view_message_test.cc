// What the decoder of the live view's messages takes, and what it refuses.
#include "runtime/view/view_message.h"

#include <cmath>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

TEST(ViewMessage, PointCarriesTheTarget) {
  const ViewRequest request = decode_view_message(
      R"({"type": "point", "hold": true, "target_m": [0.01, -0.02, 3e-3]})");
  EXPECT_EQ(request.action, ViewAction::kPoint);
  EXPECT_TRUE(request.hold);
  EXPECT_EQ(request.target_m, Eigen::Vector3d(0.01, -0.02, 0.003));
}

TEST(ViewMessage, LettingGoNeedsNoTarget) {
  EXPECT_FALSE(decode_view_message(R"({"type":"point","hold":false})").hold);
}

TEST(ViewMessage, PointMayNameAHandAndTurnItsTool) {
  const ViewRequest plain =
      decode_view_message(R"({"type":"point","hold":true,"target_m":[0,0,0]})");
  EXPECT_FALSE(plain.hand);
  EXPECT_FALSE(plain.turn);
  const ViewRequest request = decode_view_message(
      R"({"type":"point","hold":true,"hand":1,"target_m":[0,0,0],"turn":[0,0,0.6,0.6]})");
  EXPECT_EQ(request.hand, 1);
  ASSERT_TRUE(request.turn);
  EXPECT_NEAR(request.turn->norm(), 1.0, 1e-15);
  EXPECT_NEAR(request.turn->z(), std::sqrt(0.5), 1e-15);
  EXPECT_EQ(decode_view_message(R"({"type":"point","hold":false,"hand":0})").hand, 0);
}

TEST(ViewMessage, ContactsAreCoupledOrNot) {
  EXPECT_EQ(decode_view_message(R"({"type":"set","coupled":false})").coupled, false);
  EXPECT_FALSE(decode_view_message(R"({"type":"set","slow_hz":20})").coupled);
}

TEST(ViewMessage, SetCarriesWhatIsThereAndNothingElse) {
  const ViewRequest request =
      decode_view_message(R"({"type":"set","slow_hz":20,"friction":null})");
  EXPECT_EQ(request.slow_hz, 20.0);
  EXPECT_TRUE(request.database_friction);
  EXPECT_FALSE(request.friction);
  EXPECT_FALSE(request.model);
  EXPECT_FALSE(request.stiffness_scale);
}

TEST(ViewMessage, NodesAreAskedForTheirCurvesOrFields) {
  const ViewRequest curve = decode_view_message(R"({"type":"node","node":12})");
  EXPECT_EQ(curve.action, ViewAction::kNode);
  EXPECT_EQ(curve.node, 12);
  const ViewRequest field = decode_view_message(R"({"type":"field","node":0})");
  EXPECT_EQ(field.action, ViewAction::kField);
  EXPECT_EQ(field.node, 0);
}

TEST(ViewMessage, ADeviceIsAskedForKeptAndLetGoOf) {
  const ViewRequest on = decode_view_message(
      R"({"type":"device","do":"on","node":7,"right":[0.6,0,0.8],"limit":true})");
  EXPECT_EQ(on.action, ViewAction::kDevice);
  EXPECT_EQ(on.node, 7);
  EXPECT_EQ(on.right, Eigen::Vector3d(0.6, 0.0, 0.8));
  EXPECT_TRUE(on.limit);
  EXPECT_EQ(decode_view_message(R"({"type":"device","do":"on","node":7,)"
                                R"("right":[1.0000000000000002,0,0],"limit":false})")
                .right.x(),
            1.0 + 0x1p-52);
  EXPECT_EQ(decode_view_message(R"({"type":"device","do":"keep"})").action,
            ViewAction::kDeviceKept);
  EXPECT_EQ(decode_view_message(R"({"type":"device","do":"off"})").action,
            ViewAction::kDeviceOff);
}

TEST(ViewMessage, EveryModelHasItsName) {
  for (const LocalModel model : kLocalModels) {
    const std::string text =
        R"({"type":"set","model":")" + std::string(name(model)) + "\"}";
    EXPECT_EQ(decode_view_message(text).model, model);
  }
}

TEST(ViewMessage, TheLargestMessageIsTakenAndOneByteMoreIsNot) {
  std::string text = R"({"type":"run","do":"pause"})";
  text.resize(kViewMessageBytes, ' ');
  EXPECT_EQ(decode_view_message(text).action, ViewAction::kPause);
  text += ' ';
  EXPECT_THROW(static_cast<void>(decode_view_message(text)), InputError);
}

class RefusedMessage : public testing::TestWithParam<const char*> {};

TEST_P(RefusedMessage, IsAnInputErrorOfOneLineWithoutItsText) {
  try {
    static_cast<void>(decode_view_message(GetParam()));
    FAIL() << "was taken: " << GetParam();
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find('\n'), std::string::npos);
    EXPECT_EQ(what.find("evil"), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, RefusedMessage,
    testing::Values(
        "", "null", "[]", "{", "{}", "\xff\xfe", R"({"type":1})", R"({"type":"evil"})",
        R"({"type":"point"})", R"({"type":"point","hold":1})",
        R"({"type":"point","hold":true})",
        R"({"type":"point","hold":true,"target_m":[0,0]})",
        R"({"type":"point","hold":true,"target_m":[0,0,1e300]})",
        R"({"type":"point","hold":true,"target_m":[0,0,1e999]})",
        R"({"type":"point","hold":true,"target_m":[0,0,NaN]})",
        R"({"type":"point","hold":true,"target_m":[0,0,"evil"]})",
        R"({"type":"point","hold":false,"evil":0})",
        R"({"type":"point","hold":false,"hand":2})",
        R"({"type":"point","hold":false,"hand":0.5})",
        R"({"type":"point","hold":false,"hand":"evil"})",
        R"({"type":"point","hold":false,"turn":[0,0,0,1]})",
        R"({"type":"point","hold":true,"target_m":[0,0,0],"turn":[0,0,1]})",
        R"({"type":"point","hold":true,"target_m":[0,0,0],"turn":[0,0,0,0.4]})",
        R"({"type":"point","hold":true,"target_m":[0,0,0],"turn":[0,0,0,2]})",
        R"({"type":"set","coupled":1})", R"({"type":"set"})",
        R"({"type":"set","slow_hz":0})", R"({"type":"set","slow_hz":2001})",
        R"({"type":"set","slow_hz":null})", R"({"type":"set","model":"evil"})",
        R"({"type":"set","friction":-0.1})", R"({"type":"set","stiffness_scale":0})",
        R"({"type":"run"})", R"({"type":"run","do":"evil"})", R"({"type":"node"})",
        R"({"type":"node","node":-1})", R"({"type":"node","node":1.5})",
        R"({"type":"node","node":4294967296})", R"({"type":"field"})",
        R"({"type":"device"})", R"({"type":"device","do":"evil"})",
        R"({"type":"device","do":"on"})", R"({"type":"device","do":"keep","node":0})",
        R"({"type":"device","do":"on","node":0,"right":[1,0],"limit":false})",
        R"({"type":"device","do":"on","node":0,"right":[2,0,0],"limit":false})",
        R"({"type":"device","do":"on","node":0,"right":[1,0,0],"limit":1})",
        R"({"type":"device","do":"on","node":-1,"right":[1,0,0],"limit":false})",
        R"({"type":"field","node":-1})", R"({"type":"field","node":0,"evil":0})"));

}  // namespace
}  // namespace palpate
