#include "runtime/usb/haply_packet.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(HaplyPacket, SetUpHasTheBytesOfTheTwoMotorBoard) {
  const auto bytes = encode(HaplySetup{});
  const std::array<std::uint8_t, 10> head{1, 5, 3, 0, 0, 3, 0, 0, 0, 0};
  EXPECT_TRUE(std::equal(head.begin(), head.end(), bytes.begin()));
  // 180 is 0x43340000, 13 824 is 0x46580000, least significant byte first.
  const std::array<std::uint8_t, 8> first{0, 0, 0x34, 0x43, 0, 0, 0x58, 0x46};
  EXPECT_TRUE(std::equal(first.begin(), first.end(), bytes.begin() + 10));
}

TEST(HaplyPacket, TorquesAreClampedAndWhatIsNoNumberIsZero) {
  const auto bytes = encode_torques(5, {0.5, std::nan("")});
  EXPECT_EQ(bytes[0], 2);
  EXPECT_EQ(bytes[1], 5);
  const auto torque = decode_torques(bytes);
  EXPECT_FLOAT_EQ(static_cast<float>(torque[0]), 0.123F);
  EXPECT_EQ(torque[1], 0.0);
}

TEST(HaplyPacket, AnglesComeBackAsFloats) {
  const auto angles = decode_angles(5, encode_angles(5, {123.456, -17.25}));
  ASSERT_TRUE(angles.has_value());
  EXPECT_NEAR((*angles)[0], 123.456, 123.456 * 0x1p-24);
  EXPECT_EQ((*angles)[1], -17.25);
}

TEST(HaplyPacket, AStreamOutOfStepIsNoAngle) {
  EXPECT_FALSE(decode_angles(5, encode_angles(6, {1.0, 2.0})).has_value());
  EXPECT_FALSE(decode_angles(5, encode_angles(5, {std::nan(""), 2.0})).has_value());
  EXPECT_FALSE(decode_angles(5, encode_angles(5, {1.0, 1e9})).has_value());
}

}  // namespace
}  // namespace palpate
