#include "runtime/emulation/emulated_usb_device.h"

#include <algorithm>
#include <cerrno>

namespace palpate {
namespace {

std::uint8_t low(std::uint16_t value) {
  return static_cast<std::uint8_t>(value & 0xFF);
}

std::uint8_t high(std::uint16_t value) {
  return static_cast<std::uint8_t>(value >> 8);
}

}  // namespace

std::vector<std::uint8_t> descriptors_of(const UsbIdentity& id) {
  const auto endpoint = [&id](std::uint8_t address) {
    return std::vector<std::uint8_t>{
        7, 5, address, 2, low(id.packet_bytes), high(id.packet_bytes), 0};
  };
  std::vector<std::uint8_t> all{
      18, 1, 0x00, 0x02, 0, 0, 0, 64, low(id.vendor), high(id.vendor), low(id.product),
      high(id.product), 0, 1, 0, 0, 0, 1,
      // configuration of 9 + 9 + 7 + 7 bytes
      9, 2, 32, 0, 1, 1, 0, 0x80, 250,
      // interface
      9, 4, id.interface, 0, 2, id.interface_class, 0xFF, 0xFF, 0};
  for (const std::uint8_t address : {id.in, id.out}) {
    const auto bytes = endpoint(address);
    all.insert(all.end(), bytes.begin(), bytes.end());
  }
  return all;
}

int FaultyUsb::trouble() noexcept {
  if (reached(faults_.unplug_at_byte)) {
    return faults_.unplug_is_io_error ? -EPROTO : -ENODEV;
  }
  if (reached(faults_.stall_at_byte)) {
    faults_.stall_at_byte = -1;
    return -EPIPE;
  }
  return 0;
}

int FaultyUsb::control(const UsbSetup& setup, std::int64_t now_ns) {
  bytes_ += 8;
  const int wrong = trouble();
  return wrong != 0 ? wrong : model_.control(setup, now_ns);
}

int FaultyUsb::send(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  const std::int64_t left = faults_.unplug_at_byte - bytes_;
  const auto size = static_cast<std::int64_t>(bytes.size());
  bytes_ += size;
  if (const int wrong = trouble(); wrong != 0) {
    if (left > 0 && left < size) {  // what had crossed has crossed
      static_cast<void>(
          model_.send(bytes.first(static_cast<std::size_t>(left)), now_ns));
    }
    return wrong;
  }
  return silent() ? static_cast<int>(size) : model_.send(bytes, now_ns);
}

int FaultyUsb::receive(std::span<std::uint8_t> packet, std::int64_t now_ns) {
  if (const int wrong = trouble(); wrong != 0) {
    return wrong;
  }
  if (silent()) {
    return -EAGAIN;
  }
  const int got = model_.receive(packet, now_ns);
  bytes_ += std::max(got, 0);
  return got;
}

std::int64_t FaultyUsb::next_ns(std::int64_t now_ns) {
  const bool quiet = silent();
  return quiet ? now_ns + kMillisecondNs : model_.next_ns(now_ns);
}

}  // namespace palpate
