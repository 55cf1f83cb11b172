#include "runtime/device_choice.h"

#include <array>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "formats/error.h"
#include "runtime/emulated_falcon.h"
#include "runtime/haply_model.h"
#include "runtime/usb_choice.h"

namespace palpate {
namespace {

// Middle of the workspace [m].
const Eigen::Vector3d haply_rest_m(0.0, 0.09, 0.0);

FalconConfig falcon_config(const DeviceRequest& request) {
  if (!(request.calibration > 0.0 && request.calibration <= 10.0)) {
    throw InputError(fmt::format("calibration factor is {}, must lie in (0, 10]",
                                 request.calibration));
  }
  if (!(request.homing_s > 0.0 && request.homing_s < 1e4)) {
    throw InputError(
        fmt::format("time for homing is {} s, must lie in (0, 1e4)", request.homing_s));
  }
  FalconConfig config;
  config.calibration = request.calibration;
  config.homing_s = request.homing_s;
  config.tell = request.tell;
  config.what = request.name;
  if (!request.firmware.empty()) {
    config.firmware = read_firmware(request.firmware);
  }
  return config;
}

// The usbfs file of the one device that is meant.
int open_usb(const DeviceRequest& request, bool (*is_meant)(const UsbDevice&)) {
  const UsbDevice device =
      choose_usb_device(find_usb_devices(), request.name, request.usb, is_meant);
  const std::string file =
      fmt::format("/dev/bus/usb/{:03}/{:03}", device.bus, device.address);
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) {
    throw DeviceError(
        fmt::format("{}: {}: {}", request.name, file, std::strerror(errno)));
  }
  return descriptor;
}

void close_usb(int descriptor) {
  ::close(descriptor);
}

AttachedDevice falcon(const DeviceRequest& request) {
  const FalconConfig config = falcon_config(request);
  return attach(FalconLink(config, nullptr, nullptr).limits(), falcon_centre_m(),
                [config, request](const HandScript&) {
                  return std::make_unique<FalconLink>(
                      config,
                      [request] {
                        return open_usb(request, [](const UsbDevice& device) {
                          return device.vendor == kFalconIdentity.vendor &&
                                 device.product == kFalconIdentity.product;
                        });
                      },
                      close_usb);
                });
}

AttachedDevice emulated_falcon(const DeviceRequest& request) {
  FalconConfig config = falcon_config(request);
  if (config.firmware.empty()) {
    config.firmware = emulated_firmware();
  }
  return attach(FalconLink(config, nullptr, nullptr).limits(), falcon_centre_m(),
                [config](const HandScript& hand) {
                  EmulatedFalconConfig emulated;
                  emulated.model.hand = hand;
                  emulated.model.start_m = hand.at(0.0).position_m;
                  emulated.model.dynamics.resolution_m = 0.0;  // the encoders' own
                  return EmulatedFalcon::link(
                      std::make_shared<EmulatedFalcon>(emulated), config);
                });
}

HaplyConfig haply_config(const DeviceRequest& request) {
  if (!request.firmware.empty()) {
    throw InputError(
        fmt::format("--firmware {}: a {} has its own", request.firmware, request.name));
  }
  HaplyConfig config;
  config.what = request.name;
  return config;
}

AttachedDevice haply(const DeviceRequest& request) {
  const HaplyConfig config = haply_config(request);
  return attach(HaplyLink(config, nullptr, nullptr).limits(), haply_rest_m,
                [config, request](const HandScript&) {
                  return std::make_unique<HaplyLink>(
                      config,
                      [request] {
                        return open_usb(request, [](const UsbDevice& device) {
                          return device.serial;
                        });
                      },
                      close_usb);
                });
}

AttachedDevice emulated_haply(const DeviceRequest& request) {
  const HaplyConfig config = haply_config(request);
  return attach(HaplyLink(config, nullptr, nullptr).limits(), haply_rest_m,
                [config](const HandScript& hand) {
                  HaplyModelConfig emulated;
                  emulated.hand = hand;
                  emulated.start_m = hand.at(0.0).position_m;
                  emulated.dynamics.resolution_m = 0.0;
                  return EmulatedHaply::link(
                      std::make_shared<EmulatedHaply>(emulated, UsbFaults{}), config);
                });
}

struct KnownDevice {
  const char* name;
  AttachedDevice (*attach)(const DeviceRequest&);
};
constexpr std::array<KnownDevice, 4> kKnown{{{"falcon", falcon},
                                             {"haply-2diy", haply},
                                             {"emulated-falcon", emulated_falcon},
                                             {"emulated-haply", emulated_haply}}};

}  // namespace

std::string known_device_names() {
  std::string names;
  for (const KnownDevice& known : kKnown) {
    names += (names.empty() ? "" : ", ") + std::string(known.name);
  }
  return names;
}

AttachedDevice choose_device(const DeviceRequest& request) {
  for (const KnownDevice& known : kKnown) {
    if (request.name == known.name) {
      return known.attach(request);
    }
  }
  throw InputError(fmt::format("--device {}: unknown device; known: {}", request.name,
                               known_device_names()));
}

}  // namespace palpate
