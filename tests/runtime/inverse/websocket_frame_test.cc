// Frames: the examples of RFC 6455, section 5.7; whatever is written is read, however
// it arrives; what is no frame is refused by name.
#include "runtime/inverse/websocket_frame.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

using Bytes = std::string;

Bytes written(FrameOpcode opcode, bool last, const Bytes& payload,
              const FrameMask* mask) {
  Bytes bytes(payload.size() + kFrameHeaderBytes, '\0');
  bytes.resize(write_frame(bytes, opcode, last, payload, mask));
  return bytes;
}

FrameRead read_all(WebsocketReader& reader, const Bytes& bytes) {
  std::copy(bytes.begin(), bytes.end(), reader.room().begin());
  reader.add(bytes.size());
  return reader.read();
}

std::string why_refused(const Bytes& bytes, bool masked) {
  WebsocketReader reader(masked);
  FrameRead read = read_all(reader, bytes);
  while (read == FrameRead::kPart) {
    read = reader.read();
  }
  EXPECT_EQ(read == FrameRead::kInvalid, reader.failure() != nullptr);
  EXPECT_EQ(reader.read() == FrameRead::kInvalid, reader.failure() != nullptr);
  return reader.failure() == nullptr ? "" : reader.failure();
}

TEST(WebsocketFrame, WritesAndReadsTheStandardsExamples) {
  const FrameMask mask{'\x37', '\xfa', '\x21', '\x3d'};
  const Bytes plain = "\x81\x05Hello";
  const Bytes masked = "\x81\x85\x37\xfa\x21\x3d\x7f\x9f\x4d\x51\x58";
  EXPECT_EQ(written(FrameOpcode::kText, true, "Hello", nullptr), plain);
  EXPECT_EQ(written(FrameOpcode::kText, true, "Hello", &mask), masked);
  for (const bool by_client : {false, true}) {
    WebsocketReader reader(by_client);
    ASSERT_EQ(read_all(reader, by_client ? masked : plain), FrameRead::kMessage);
    EXPECT_EQ(reader.payload(), "Hello");
    EXPECT_EQ(reader.read(), FrameRead::kIncomplete);
  }
  // In two frames, with a ping between them.
  WebsocketReader reader(false);
  EXPECT_EQ(read_all(reader, "\x01\x03Hel"), FrameRead::kPart);
  EXPECT_EQ(read_all(reader, "\x89\x05World"), FrameRead::kPing);
  EXPECT_EQ(reader.payload(), "World");
  EXPECT_EQ(read_all(reader, Bytes("\x8a\x00", 2)), FrameRead::kPart);
  EXPECT_EQ(read_all(reader, "\x80\x02lo"), FrameRead::kMessage);
  EXPECT_EQ(reader.payload(), "Hello");
  EXPECT_EQ(read_all(reader, "\x88\x02\x03\xe8"), FrameRead::kClose);
  EXPECT_EQ(reader.payload(), "\x03\xe8");
}

// Lengths at the bounds of their three spellings; byte by byte, and two at once.
TEST(WebsocketFrame, ReadsWhatWasWrittenHoweverItArrives) {
  const FrameMask mask{'\x01', '\x7f', '\x80', '\xff'};
  for (const std::size_t size : {0, 1, 125, 126, 65535, 65536}) {
    Bytes text(size, ' ');
    for (std::size_t i = 0; i < size; ++i) {
      text[i] = static_cast<char>(i * 31 % 251);
    }
    for (const FrameMask* with : {static_cast<const FrameMask*>(nullptr), &mask}) {
      const Bytes frame = written(FrameOpcode::kText, true, text, with);
      const std::size_t header = size < 126 ? 2 : size < 65536 ? 4 : 10;
      ASSERT_EQ(frame.size(), size + header + (with == nullptr ? 0 : 4));
      WebsocketReader reader(with != nullptr);
      for (std::size_t i = 0; i + 1 < frame.size(); i += i < 20 ? 1 : 4096) {
        const std::size_t next = std::min(i < 20 ? i + 1 : i + 4096, frame.size() - 1);
        ASSERT_EQ(read_all(reader, frame.substr(i, next - i)), FrameRead::kIncomplete);
      }
      ASSERT_EQ(read_all(reader, frame.back() + frame.substr(0, 20)),
                FrameRead::kMessage);
      EXPECT_EQ(reader.payload(), text);
    }
  }
}

TEST(WebsocketFrame, RefusesWhatIsNoFrameOrTooLong) {
  const char* const kNone = "a frame that is none of the protocol's";
  const char* const kLong = "a message that is too long";
  const char* const kNoText = "a message that is no text";
  EXPECT_EQ(why_refused("\x81\x05Hello", false), "");
  EXPECT_EQ(why_refused("\x81\x05Hello", true), kNone);  // clients mask
  EXPECT_EQ(why_refused("\x81\x85Hello", false), kNone);
  EXPECT_EQ(why_refused("\xc1\x05Hello", false), kNone);  // compressed
  EXPECT_EQ(why_refused("\x09\x05Hello", false), kNone);  // half a ping
  EXPECT_EQ(why_refused("\x89\x7e\x01\x01", false), kNone);
  EXPECT_EQ(why_refused("\x82\x05Hello", false), kNoText);
  EXPECT_EQ(why_refused("\x80\x05Hello", false), kNoText);
  EXPECT_EQ(why_refused("\x01\x01H\x81\x01H", false), kNoText);
  EXPECT_EQ(why_refused(Bytes("\x81\x7f\0\0\0\0\0\x01\0\x01", 10), false), kLong);
  EXPECT_EQ(why_refused("\x81\x7f\xff\xff\xff\xff\xff\xff\xff\xff", false), kLong);
  const Bytes half(40000, 'a');
  EXPECT_EQ(why_refused(written(FrameOpcode::kText, false, half, nullptr) +
                            written(FrameOpcode::kContinuation, true, half, nullptr),
                        false),
            kLong);
}

TEST(WebsocketFrame, AShorterMessageMayBeTheLongest) {
  WebsocketReader reader(false, 16);
  EXPECT_EQ(
      read_all(reader, written(FrameOpcode::kText, true, Bytes(16, 'a'), nullptr)),
      FrameRead::kMessage);
  EXPECT_EQ(read_all(reader, "\x81\x11"), FrameRead::kInvalid);
  EXPECT_EQ(reader.failure_code(), CloseCode::kTooLong);
}

}  // namespace
}  // namespace palpate
