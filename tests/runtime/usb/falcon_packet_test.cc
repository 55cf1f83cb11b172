#include "runtime/usb/falcon_packet.h"

#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

std::string text(const FalconPacket& packet) {
  return {packet.begin(), packet.end()};
}

TEST(FalconPacket, HasTheKnownBytesOfAValueAndOfTheIdleCommand) {
  const FalconPacket packet = encode(FalconCommand{.motor = {-1447, 0, 0}});
  EXPECT_EQ(text(packet).substr(1, 4), "\x4A\x46\x4B\x50");
  EXPECT_EQ(text(encode(FalconCommand{.motor = {}, .leds = 0, .homing = false})),
            "<AAAAAAAAAAAAAA>");
}

TEST(FalconPacket, GivesBackEveryValueOfAnEncoder) {
  for (int value = -32768; value <= 32767; ++value) {
    const auto v = static_cast<std::int16_t>(value);
    const auto w = static_cast<std::int16_t>(~value);
    const auto reply = decode_reply(
        encode(FalconReply{.encoder = {v, w, 7}, .buttons = 5, .homed = 3}));
    ASSERT_TRUE(reply.has_value());
    ASSERT_EQ(reply->encoder, (std::array<std::int16_t, 3>{v, w, 7}));
    ASSERT_EQ(reply->buttons, 5);
    ASSERT_EQ(reply->homed, 3);
  }
}

TEST(FalconPacket, GivesBackLedsAndHoming) {
  const auto command = decode_command(
      encode(FalconCommand{.motor = {1, -2, 3}, .leds = kFalconRed, .homing = true}));
  ASSERT_TRUE(command.has_value());
  EXPECT_EQ(command->leds, kFalconRed);
  EXPECT_TRUE(command->homing);
  EXPECT_EQ(command->motor[1], -2);
}

TEST(FalconPacket, RefusesABrokenFrameOrNibble) {
  const FalconPacket good = encode(FalconReply{.encoder = {100, 200, 300}});
  for (std::size_t i = 0; i < kFalconPacketBytes; ++i) {
    FalconPacket bad = good;
    bad[i] = 0x40;  // below every nibble, no frame
    EXPECT_EQ(decode_reply(bad).has_value(), i == 14) << i;  // 14 is not known
  }
}

TEST(FalconFramer, FindsEveryPacketBehindGarbageAndAcrossPieces) {
  std::mt19937 random(1);
  FalconFramer framer;
  int found = 0;
  constexpr int kPackets = 2000;
  for (int k = 0; k < kPackets; ++k) {
    // Garbage without a '<' cannot hide a packet.
    for (auto junk = random() % 5; junk > 0; --junk) {
      EXPECT_FALSE(framer.add(static_cast<std::uint8_t>(0x60 + random() % 64)));
    }
    for (const std::uint8_t byte :
         encode(FalconReply{.encoder = {static_cast<std::int16_t>(k), 0, 0}})) {
      const auto packet = framer.add(byte);
      if (packet) {
        EXPECT_EQ(decode_reply(*packet)->encoder[0], k);
        ++found;
      }
    }
  }
  EXPECT_EQ(found, kPackets);
}

TEST(FalconFramer, LosesAtMostOnePacketToAStartThatIsNone) {
  FalconFramer framer;
  EXPECT_FALSE(framer.add('<'));  // the rest of it was lost
  int found = 0;
  for (int k = 0; k < 3; ++k) {
    for (const std::uint8_t byte : encode(FalconReply{})) {
      found += framer.add(byte) ? 1 : 0;
    }
  }
  EXPECT_GE(found, 2);
  EXPECT_GT(framer.dropped(), 0U);
}

}  // namespace
}  // namespace palpate
