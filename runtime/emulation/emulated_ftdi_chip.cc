#include "runtime/emulation/emulated_ftdi_chip.h"

#include <algorithm>
#include <cerrno>

namespace palpate {
namespace {

constexpr std::size_t kPayload = 62;

}  // namespace

int FtdiChip::control(const UsbSetup& setup, std::int64_t /*now_ns*/) {
  if (setup.request_type != 0x40) {
    return -EPIPE;
  }
  // Vendor requests of an FTDI chip: 0 reset and purge, 1 modem lines, 2 flow control,
  // 3 divisor of the baud rate. Further 4 bits and parity, 6 event character, 9 latency
  // [ms]. A high byte of 1 marks DTR as changed, or the event as enabled.
  switch (setup.request) {
    case 0x00:
      if (setup.value != 2) {
        waiting_.clear();
      }
      return 0;
    case 0x01:
      if ((setup.value & 0x0100) != 0) {
        end_.set_dtr((setup.value & 1) != 0);
      }
      return 0;
    case 0x03:
      divisor_ = setup.value;
      return 0;
    case 0x06:
      event_ = (setup.value & 0x0100) != 0 ? setup.value & 0xFF : -1;
      return 0;
    case 0x09:
      latency_ns_ = kMillisecondNs * std::clamp<std::int64_t>(setup.value, 1, 255);
      return 0;
    case 0x02:
    case 0x04:
      return 0;
    default:
      return -EPIPE;
  }
}

// The clock of 3 MHz by the divisor's integer part; eighths do not matter here.
std::int64_t FtdiChip::byte_ns() const noexcept {
  const std::int64_t divisor = std::max(1, divisor_ & 0x3FFF);
  return 10 * divisor * 1000 / 3;
}

void FtdiChip::answered(std::uint8_t byte) {
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  from_end_ns_ = std::max(from_end_ns_, to_end_ns_) + byte_ns();
  if (chance(random_) < faults_.drop) {
    return;
  }
  const bool garbled = chance(random_) < faults_.garbage;
  const std::uint8_t heard =
      garbled ? static_cast<std::uint8_t>(random_() & 0xFF) : byte;
  waiting_.emplace_back(from_end_ns_, heard);
  if (heard == event_ && event_ns_ < 0) {
    event_ns_ = from_end_ns_;
  }
}

int FtdiChip::send(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  to_end_ns_ = std::max(to_end_ns_, now_ns);
  std::vector<std::uint8_t> answer;
  for (const std::uint8_t byte : bytes) {
    to_end_ns_ += byte_ns();
    answer.clear();
    end_.take(byte, divisor_, to_end_ns_, answer);
    for (const std::uint8_t back : answer) {
      answered(back);
    }
  }
  return static_cast<int>(bytes.size());
}

int FtdiChip::receive(std::span<std::uint8_t> packet, std::int64_t now_ns) {
  if (now_ns < next_ns(now_ns) || packet.size() < kFtdiStatusBytes) {
    return -EAGAIN;
  }
  packet_ns_ = now_ns;
  event_ns_ = event_ns_ <= now_ns ? -1 : event_ns_;
  packet[0] = 0x01;
  packet[1] = 0x60;
  std::size_t count = kFtdiStatusBytes;
  const std::size_t most = std::min(
      packet.size(), kFtdiStatusBytes + std::min(kPayload, faults_.split_bytes));
  while (count < most && !waiting_.empty() && waiting_.front().first <= now_ns) {
    packet[count++] = waiting_.front().second;
    waiting_.pop_front();
  }
  return static_cast<int>(count);
}

std::int64_t FtdiChip::next_ns(std::int64_t /*now_ns*/) {
  std::int64_t next_ns = packet_ns_ + latency_ns_;
  if (waiting_.size() >= kPayload) {
    next_ns = std::min(next_ns, waiting_[kPayload - 1].first);
  }
  return event_ns_ < 0 ? next_ns : std::min(next_ns, event_ns_);
}

}  // namespace palpate
