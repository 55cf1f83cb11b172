#include "runtime/usb/inverse3_packet.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Inverse3Packet, RealsAreLittleEndianAfterOneByte) {
  const auto bytes = encode_inverse3_force({1.0, -2.0, 0.5});
  const std::array<std::uint8_t, kInverse3ForceBytes> wanted{
      0x2A, 0, 0, 0x80, 0x3F, 0, 0, 0, 0xC0, 0, 0, 0, 0x3F};  // IEEE 754
  EXPECT_EQ(bytes, wanted);
  EXPECT_EQ(decode_inverse3_force(bytes), Eigen::Vector3d(1.0, -2.0, 0.5));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(decode_inverse3_force(encode_inverse3_force({1.0, nan, 0.0})),
            Eigen::Vector3d::Zero());
}

TEST(Inverse3Packet, WhatCannotBeIsNoPosition) {
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  EXPECT_TRUE(decode_inverse3_position(encode_inverse3_state({0.1, 0.2, 0.3}, zero)));
  EXPECT_FALSE(decode_inverse3_position(encode_inverse3_state({0.1, 1.1, 0.3}, zero)));
  EXPECT_FALSE(decode_inverse3_position(encode_inverse3_state(zero, {30.0, 0.0, 0.0})));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(decode_inverse3_position(encode_inverse3_state({nan, 0.0, 0.0}, zero)));
  Inverse3State other = encode_inverse3_state(zero, zero);
  other[0] = 0x1B;
  EXPECT_FALSE(decode_inverse3_position(other));
}

TEST(Inverse3Packet, HeartbeatsArePassedOverAndNonsenseIsNot) {
  using Found = Inverse3Framer::Found;
  const Inverse3State state = encode_inverse3_state({0.1, 0.2, 0.3}, {1.0, 2.0, 3.0});
  std::vector<std::uint8_t> bytes{0xBA, 0x02, 0x02, 0x2B, 0xBA};
  bytes.insert(bytes.end(), state.begin(), state.end());
  bytes.insert(bytes.end(), {0xBA, 0x02, 0x02, 0, 0, 0xBA, 0x02, 0x03});
  Inverse3Framer framer;
  int states = 0;
  for (std::size_t i = 0; i + 1 < bytes.size(); ++i) {
    const Found found = framer.take(bytes[i]);
    EXPECT_NE(found, Found::kNonsense) << i;
    if (found == Found::kState) {
      ++states;
      EXPECT_EQ(framer.state(), state);
    }
  }
  EXPECT_EQ(states, 1);
  EXPECT_EQ(framer.take(bytes.back()), Found::kNonsense);
}

}  // namespace
}  // namespace palpate
