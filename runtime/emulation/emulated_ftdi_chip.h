// An FTDI FT232 in simulation: a serial line behind a bulk pair. Time is passed in.
#pragma once

#include <cstdint>
#include <deque>
#include <random>
#include <utility>
#include <vector>

#include "runtime/emulation/emulated_usb_device.h"

namespace palpate {

constexpr std::size_t kFtdiStatusBytes = 2;  ///< at the start of every IN packet

/// What the chip's serial line ends in.
class SerialEnd {
 public:
  SerialEnd() = default;
  virtual ~SerialEnd() = default;
  SerialEnd(const SerialEnd&) = delete;
  SerialEnd& operator=(const SerialEnd&) = delete;

  virtual void set_dtr(bool high) = 0;
  /// Takes a byte that was sent at a baud divisor; appends what it answers.
  virtual void take(std::uint8_t byte, std::uint16_t divisor, std::int64_t now_ns,
                    std::vector<std::uint8_t>& answer) = 0;
};

struct SerialFaults {
  std::size_t split_bytes = 62;  ///< [1, 62] most of an answer in one packet
  double garbage = 0.0;          ///< [0, 1] of answered bytes are others
  double drop = 0.0;             ///< [0, 1] of answered bytes are lost
};

/// Bytes take their time on the line (10 bits each). An IN packet leaves when it is
/// full, when the event character has come, or when the latency timer runs out, with or
/// without data. Every packet restarts the timer.
class FtdiChip : public UsbModel {
 public:
  FtdiChip(SerialEnd& end, const UsbIdentity& identity, const SerialFaults& faults)
      : end_(end), identity_(identity), faults_(faults) {}

  [[nodiscard]] std::vector<std::uint8_t> descriptors() const override {
    return descriptors_of(identity_);
  }
  [[nodiscard]] int control(const UsbSetup& setup, std::int64_t now_ns) override;
  [[nodiscard]] int send(std::span<const std::uint8_t> bytes,
                         std::int64_t now_ns) override;
  [[nodiscard]] int receive(std::span<std::uint8_t> packet,
                            std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_ns(std::int64_t now_ns) override;

 private:
  [[nodiscard]] std::int64_t byte_ns() const noexcept;
  void answered(std::uint8_t byte);

  SerialEnd& end_;
  UsbIdentity identity_;
  SerialFaults faults_;
  std::mt19937 random_{1};
  std::uint16_t divisor_ = 0x4138;
  std::int64_t latency_ns_ = 16'000'000;
  std::int64_t to_end_ns_ = 0;  // the line is busy until
  std::int64_t from_end_ns_ = 0;
  std::int64_t packet_ns_ = 0;  // latest IN packet
  int event_ = -1;              // byte that sends what waits; -1: none
  std::int64_t event_ns_ = -1;  // when it came; -1: it does not wait
  std::deque<std::pair<std::int64_t, std::uint8_t>> waiting_{};  // by arrival
};

}  // namespace palpate
