// Bytes to and from a USB device's bulk pair over libusb: transfers that are allocated
// once, one thread, a deadline for everything.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace palpate {

enum class UsbStatus : std::uint8_t {
  kOk,
  kTimeout,  ///< the deadline passed
  kLost,     ///< gone, or errors without end; stays
};

/// Answers one after another that a link rejects before it gives up.
constexpr int kRejectedMax = 20;

struct UsbPair {
  int interface = 0;
  std::uint8_t out = 0x02;
  std::uint8_t in = 0x81;
  std::size_t packet_bytes = 64;
  std::size_t status_bytes = 0;  ///< stripped from the start of every IN packet
};

struct UsbRequest {
  std::uint8_t request_type = 0x40;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
};

/// [ns] `wait_s` from now, by the clock that the deadlines below are of.
[[nodiscard]] std::int64_t deadline_ns_after(double wait_s) noexcept;

/// Claims the interface, with the kernel's driver detached, and keeps IN transfers
/// submitted. All calls from one thread. The destructor cancels what is under way,
/// releases the interface and attaches the kernel's driver again.
class UsbTransport {
 public:
  /// @param descriptor of the device's usbfs file, open for writing; stays the
  /// caller's, and open while this lives. @throws DeviceError naming the step.
  UsbTransport(int descriptor, const UsbPair& pair);
  ~UsbTransport();
  UsbTransport(const UsbTransport&) = delete;
  UsbTransport& operator=(const UsbTransport&) = delete;

  /// A request without data; for set-up: waits up to a second.
  /// @throws DeviceError.
  void control(const UsbRequest& request);

  /// Sends bytes (at most packet_bytes), waits until they are out.
  [[nodiscard]] UsbStatus send(std::span<const std::uint8_t> bytes,
                               std::int64_t deadline_ns) noexcept;

  /// Waits for at least one byte. @param got bytes written to `bytes`.
  [[nodiscard]] UsbStatus receive(std::span<std::uint8_t> bytes, std::size_t& got,
                                  std::int64_t deadline_ns) noexcept;

  /// Throws away what has come so far.
  void drop_received() noexcept;

  [[nodiscard]] bool lost() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate
