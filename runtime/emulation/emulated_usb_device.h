// A USB device without a bus: what its endpoints answer, with time passed in.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

constexpr std::int64_t kMillisecondNs = 1'000'000;

struct UsbSetup {
  std::uint8_t request_type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
};

/// Times [ns] never go back. What a call returns is a number of bytes, or a negative
/// errno. The errnos are -ENODEV gone, -EPIPE stalled, -EPROTO an error on the wire,
/// -EAGAIN nothing yet.
class UsbModel {
 public:
  UsbModel() = default;
  virtual ~UsbModel() = default;
  UsbModel(const UsbModel&) = delete;
  UsbModel& operator=(const UsbModel&) = delete;

  /// Device descriptor, then the configuration's, as the kernel hands them out.
  [[nodiscard]] virtual std::vector<std::uint8_t> descriptors() const = 0;

  [[nodiscard]] virtual int control(const UsbSetup& setup, std::int64_t now_ns) = 0;
  [[nodiscard]] virtual int send(std::span<const std::uint8_t> bytes,
                                 std::int64_t now_ns) = 0;
  /// One packet of the IN endpoint.
  [[nodiscard]] virtual int receive(std::span<std::uint8_t> packet,
                                    std::int64_t now_ns) = 0;
  /// When receive() may have something [ns].
  [[nodiscard]] virtual std::int64_t next_ns(std::int64_t now_ns) = 0;
};

/// Descriptors of a device with one interface and a bulk pair.
struct UsbIdentity {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::uint8_t interface = 0;
  std::uint8_t interface_class = 0xFF;
  std::uint8_t out = 0x02;
  std::uint8_t in = 0x81;
  std::uint16_t packet_bytes = 64;
};
[[nodiscard]] std::vector<std::uint8_t> descriptors_of(const UsbIdentity& identity);

/// What goes wrong on the bus; -1: never. Bytes are counted in both directions, a
/// control request as 8.
struct UsbFaults {
  std::int64_t unplug_at_byte = -1;
  bool unplug_is_io_error = false;     ///< some host controllers: errors for ever
  std::int64_t silent_from_byte = -1;  ///< takes everything, answers nothing
  std::int64_t silent_bytes = -1;      ///< until so many were taken; -1: for ever
  std::int64_t stall_at_byte = -1;     ///< once, until cleared
};

/// A model behind a bad bus.
class FaultyUsb : public UsbModel {
 public:
  FaultyUsb(UsbModel& model, const UsbFaults& faults)
      : model_(model), faults_(faults) {}

  [[nodiscard]] std::vector<std::uint8_t> descriptors() const override {
    return model_.descriptors();
  }
  [[nodiscard]] int control(const UsbSetup& setup, std::int64_t now_ns) override;
  [[nodiscard]] int send(std::span<const std::uint8_t> bytes,
                         std::int64_t now_ns) override;
  [[nodiscard]] int receive(std::span<std::uint8_t> packet,
                            std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_ns(std::int64_t now_ns) override;

  [[nodiscard]] std::int64_t bytes() const noexcept { return bytes_; }

 private:
  [[nodiscard]] int trouble() noexcept;  // 0: none
  [[nodiscard]] bool reached(std::int64_t byte) const noexcept {
    return byte >= 0 && bytes_ >= byte;
  }

  [[nodiscard]] bool silent() const noexcept {
    return reached(faults_.silent_from_byte) &&
           (faults_.silent_bytes < 0 ||
            bytes_ < faults_.silent_from_byte + faults_.silent_bytes);
  }

  UsbModel& model_;
  UsbFaults faults_;
  std::int64_t bytes_ = 0;
};

}  // namespace palpate
