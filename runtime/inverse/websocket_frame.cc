#include "runtime/inverse/websocket_frame.h"

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

constexpr unsigned kControl = 8;  // opcodes from here on
constexpr const char* kTooLong = "a message that is too long";

constexpr unsigned code(FrameOpcode opcode) {
  return static_cast<unsigned>(opcode);
}

}  // namespace

std::size_t write_frame(std::span<char> to, FrameOpcode opcode, bool last,
                        std::span<const char> payload, const FrameMask* mask) noexcept {
  std::size_t size = 0;
  const auto put = [&](std::size_t byte) {
    to[size++] = static_cast<char>(byte);
  };
  const std::size_t masked = mask == nullptr ? 0 : 0x80;
  // RFC 6455, section 5.2, big-endian:
  //   byte 0     FIN (0x80), opcode (low four bits)
  //   byte 1     MASK (0x80), length; 126: two bytes of length follow, 127: eight
  //   then       those bytes, the mask's four if MASK is set, the payload
  put((last ? 0x80U : 0U) | code(opcode));
  if (payload.size() < 126) {
    put(masked | payload.size());
  } else {
    const bool wide = payload.size() > 0xFFFF;
    put(masked | (wide ? 127U : 126U));
    for (unsigned shift = wide ? 64 : 16; shift > 0; shift -= 8) {
      put(std::uint64_t{payload.size()} >> (shift - 8) & 0xFFU);
    }
  }
  if (mask == nullptr) {
    std::copy(payload.begin(), payload.end(), to.data() + size);
    return size + payload.size();
  }
  size = static_cast<std::size_t>(
      std::copy(mask->begin(), mask->end(), to.data() + size) - to.data());
  // Section 5.3: byte i is combined with mask byte i mod 4.
  for (std::size_t i = 0; i < payload.size(); ++i) {
    to[size++] = static_cast<char>(payload[i] ^ (*mask)[i % 4]);
  }
  return size;
}

std::span<char> WebsocketReader::room() noexcept {
  std::copy(arrived_.data() + begin_, arrived_.data() + end_, arrived_.data());
  end_ -= std::exchange(begin_, 0);
  return std::span(arrived_).subspan(end_);
}

FrameRead WebsocketReader::refuse(CloseCode code, const char* why) noexcept {
  failure_code_ = code;
  failure_ = why;
  return FrameRead::kInvalid;
}

FrameRead WebsocketReader::read() noexcept {
  if (failure_ != nullptr) {
    return FrameRead::kInvalid;
  }
  const std::span<char> bytes(arrived_.data() + begin_, end_ - begin_);
  const auto byte = [&bytes](std::size_t i) {
    return static_cast<unsigned>(static_cast<unsigned char>(bytes[i]));
  };
  if (bytes.size() < 2) {
    return FrameRead::kIncomplete;
  }
  const unsigned opcode = byte(0) & 0x0FU;
  const bool last = (byte(0) & 0x80U) != 0;
  std::uint64_t length = byte(1) & 0x7FU;
  const std::size_t extra = length == 126 ? 2 : length == 127 ? 8 : 0;
  // Refused: reserved bits, a mask where none is due or none where one is, and control
  // frames in fragments or of more than 125 bytes (5.5).
  if ((byte(0) & 0x70U) != 0 || ((byte(1) & 0x80U) != 0) != masked_ ||
      (opcode >= kControl && (!last || extra > 0))) {
    return refuse(CloseCode::kProtocol, "a frame that is none of the protocol's");
  }
  const std::size_t header = 2 + extra + (masked_ ? 4 : 0);
  if (bytes.size() < header) {
    return FrameRead::kIncomplete;
  }
  if (extra > 0) {
    length = 0;
    for (std::size_t i = 0; i < extra; ++i) {
      length = length << 8U | byte(2 + i);
    }
  }
  // Before the payload has come, so that arrived_ holds any frame that is accepted.
  if (length > message_.size()) {
    return refuse(CloseCode::kTooLong, kTooLong);
  }
  if (bytes.size() < header + length) {
    return FrameRead::kIncomplete;
  }
  const std::span<char> payload = bytes.subspan(header, length);
  for (std::size_t i = 0; masked_ && i < length; ++i) {
    payload[i] = static_cast<char>(payload[i] ^ bytes[header - 4 + i % 4]);
  }
  begin_ += header + length;
  return take(opcode, last, payload);
}

FrameRead WebsocketReader::take(unsigned opcode, bool last,
                                std::span<const char> payload) noexcept {
  payload_ = {payload.data(), payload.size()};
  if (opcode == code(FrameOpcode::kPing)) {
    return FrameRead::kPing;
  }
  if (opcode == code(FrameOpcode::kPong)) {
    return FrameRead::kPart;
  }
  if (opcode == code(FrameOpcode::kClose)) {
    return FrameRead::kClose;
  }
  // A message is one text frame and then continuations, to the frame with FIN. Control
  // frames may lie between (5.4).
  if (opcode !=
      code(message_begun_ ? FrameOpcode::kContinuation : FrameOpcode::kText)) {
    return refuse(CloseCode::kNoText, "a message that is no text");
  }
  if (message_size_ + payload.size() > message_.size()) {
    return refuse(CloseCode::kTooLong, kTooLong);
  }
  std::copy(payload.begin(), payload.end(), message_.data() + message_size_);
  message_size_ += payload.size();
  message_begun_ = !last;
  if (!last) {
    return FrameRead::kPart;
  }
  payload_ = {message_.data(), std::exchange(message_size_, 0)};
  return FrameRead::kMessage;
}

}  // namespace palpate
