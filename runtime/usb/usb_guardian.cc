#include "runtime/usb/usb_guardian.h"

#include <array>
#include <cstdint>
#include <span>

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include "runtime/usb/falcon_link.h"
#include "runtime/usb/haply_link.h"
#include "runtime/usb/inverse3_link.h"

namespace palpate {
namespace {

constexpr unsigned kWaitMs = 20;
// What was half sent when the renderer died spoils the first.
constexpr int kBulkTries = 3;

void write_bulk(int descriptor, std::uint8_t endpoint,
                std::span<std::uint8_t> bytes) noexcept {
  for (int i = 0; i < kBulkTries; ++i) {
    usbdevfs_bulktransfer transfer{.ep = endpoint,
                                   .len = static_cast<unsigned>(bytes.size()),
                                   .timeout = kWaitMs,
                                   .data = bytes.data()};
    ::ioctl(descriptor, USBDEVFS_BULK, &transfer);
  }
}

void give_back(int descriptor, int interface) noexcept {
  auto number = static_cast<unsigned>(interface);
  ::ioctl(descriptor, USBDEVFS_RELEASEINTERFACE, &number);
  usbdevfs_ioctl connect{.ifno = interface,
                         .ioctl_code = static_cast<int>(USBDEVFS_CONNECT),
                         .data = nullptr};
  ::ioctl(descriptor, USBDEVFS_IOCTL, &connect);
}

}  // namespace

void zero_falcon(int descriptor, bool last) noexcept {
  FalconPacket packet = encode(FalconCommand{.motor = {}, .leds = 0, .homing = true});
  write_bulk(descriptor, kFalconPair.out, packet);
  if (last) {
    give_back(descriptor, kFalconPair.interface);
  }
}

void zero_haply(int descriptor, bool last) noexcept {
  auto command = encode_torques(kHaplyId, {0.0, 0.0});
  write_bulk(descriptor, kHaplyPair.out, command);
  if (last) {
    give_back(descriptor, kHaplyPair.interface);
  }
}

void zero_inverse3(int descriptor, bool last) noexcept {
  auto command = encode_inverse3_force(Eigen::Vector3d::Zero());
  write_bulk(descriptor, kInverse3Pair.out, command);
  if (last) {
    give_back(descriptor, kInverse3Pair.interface);
  }
}

}  // namespace palpate
