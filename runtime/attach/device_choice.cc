#include "runtime/attach/device_choice.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/attach/driven_devices.h"
#include "runtime/attach/falcon_choice.h"
#include "runtime/attach/hung_mass.h"
#include "runtime/attach/usb_choice.h"
#include "runtime/emulation/emulated_falcon.h"
#include "runtime/emulation/emulated_haply.h"
#include "runtime/inverse/inverse_link.h"

namespace palpate {
namespace {

// Middle of the workspace [m].
const Eigen::Vector3d haply_rest_m(0.0, 0.09, 0.0);

// Of a real one.
FalconConfig guarded_falcon_config(const DeviceRequest& request) {
  FalconConfig config = falcon_config(request);
  config.guarded = true;
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

std::unique_ptr<FalconLink> falcon_link(const DeviceRequest& request,
                                        const FalconConfig& config) {
  return std::make_unique<FalconLink>(
      config,
      [request] {
        return open_usb(request, [](const UsbDevice& device) {
          return device.vendor == kFalconIdentity.vendor &&
                 device.product == kFalconIdentity.product;
        });
      },
      close_usb);
}

AttachedDevice falcon(const DeviceRequest& request) {
  const FalconConfig config = guarded_falcon_config(request);
  return attach(FalconLink(config, nullptr, nullptr).limits(), falcon_centre_m(),
                [config, request](const HandScript&) {
                  return sign_tested(request, 3, falcon_link(request, config));
                });
}

FalconConfig for_emulation(FalconConfig config) {
  config.answer_s = kEmulatedAnswerS;
  if (config.firmware.empty()) {
    config.firmware = emulated_firmware();
  }
  return config;
}

std::unique_ptr<FalconLink> emulated_falcon_link(const HandScript& hand,
                                                 const Eigen::Vector3d& start_m,
                                                 const SimulatedDeviceConfig& dynamics,
                                                 const FalconConfig& config) {
  EmulatedFalconConfig emulated;
  emulated.model.hand = hand;
  emulated.model.start_m = start_m;
  emulated.model.dynamics = dynamics;
  emulated.model.dynamics.resolution_m = 0.0;  // the encoders' own
  return EmulatedFalcon::link(std::make_shared<EmulatedFalcon>(emulated), config);
}

AttachedDevice emulated_falcon(const DeviceRequest& request) {
  const FalconConfig config = for_emulation(falcon_config(request));
  return attach(FalconLink(config, nullptr, nullptr).limits(), falcon_centre_m(),
                [config](const HandScript& hand) {
                  return emulated_falcon_link(hand, hand.at(0.0).position_m, {},
                                              config);
                });
}

// A weak spring from far below pulls like a weight. The brake lets it sink slowly until
// it is carried, and cancels over whole periods.
std::unique_ptr<DeviceLink> weighed_falcon(const FalconConfig& config, double hung_kg) {
  constexpr double kPull = 0.1;    // [N/m]
  constexpr double kBrake = 30.0;  // [N s/m]
  constexpr double kGripN = 0.3;
  HandScript pull{.surface_m = falcon_centre_m(),
                  .clear_m = 1e-9,
                  .press_m = 0.0,
                  .deeper_m = 0.0,
                  .circle_m = 0.0};
  pull.surface_m.y() -= (kGripN + kGravity * hung_kg) / kPull;
  return emulated_falcon_link(pull, falcon_centre_m(),
                              {.hand_n_per_m = kPull, .hand_n_s_per_m = kBrake},
                              config);
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

std::optional<SectionPlane> plane_of(const DeviceRequest& request) {
  return request.plane.empty() ? std::nullopt
                               : std::optional(parse_plane(request.plane));
}

// Of a real one, without the test of its signs.
std::unique_ptr<DeviceLink> haply_link(const DeviceRequest& request) {
  HaplyConfig config = haply_config(request);
  config.guarded = true;
  config.ask = request.ask;
  if (!config.ask) {
    throw DeviceError(
        fmt::format("{}: somebody must put its arms against their stops when it is set "
                    "up, and say so: run in a terminal",
                    request.name));
  }
  if (request.usb.empty()) {
    throw InputError(
        fmt::format("--device {}: name it by --usb: a printer, a modem or any other "
                    "serial board looks the same and would get its torques "
                    "(palpate-run devices lists what is attached)",
                    request.name));
  }
  return std::make_unique<HaplyLink>(
      config,
      [request] {
        return open_usb(request, [](const UsbDevice& device) {
          return device.serial;
        });
      },
      close_usb);
}

AttachedDevice haply(const DeviceRequest& request) {
  return attach(
      haply_link(request)->limits(), haply_rest_m,
      [request](const HandScript&) {
        return sign_tested(request, 2, haply_link(request));
      },
      plane_of(request));
}

AttachedDevice emulated_haply(const DeviceRequest& request) {
  return attach_emulated_haply(request, 0, nullptr);
}

Inverse3Config inverse3_config(const DeviceRequest& request) {
  if (!request.firmware.empty() || !request.plane.empty()) {
    throw InputError(
        fmt::format("--device {}: takes no --firmware or --plane", request.name));
  }
  Inverse3Config config;
  config.what = request.name;
  config.stopped = request.stopped;
  return config;
}

std::unique_ptr<DeviceLink> inverse3_link(const DeviceRequest& request) {
  Inverse3Config config = inverse3_config(request);
  config.guarded = true;
  if (request.usb.empty()) {
    throw InputError(fmt::format(
        "--device {}: name it by --usb: other boards have the same numbers and would "
        "get its forces (palpate-run devices lists what is attached)",
        request.name));
  }
  return sign_tested(request, 3,
                     std::make_unique<Inverse3Link>(
                         config,
                         [request] {
                           return open_usb(request, [](const UsbDevice& device) {
                             return device.serial && device.vendor == kInverse3Vendor &&
                                    device.product == kInverse3Product;
                           });
                         },
                         close_usb));
}

AttachedDevice inverse3(const DeviceRequest& request) {
  return attach(inverse3_link(request)->limits(), inverse_rest_m(),
                [request](const HandScript&) {
                  return inverse3_link(request);
                });
}

AttachedDevice emulated_inverse(const DeviceRequest& request) {
  return attach_emulated_inverse(request, {}, nullptr);
}

AttachedDevice emulated_inverse3(const DeviceRequest& request) {
  return attach_emulated_inverse3(request, 0, nullptr);
}

struct KnownDevice {
  const char* name;
  AttachedDevice (*attach)(const DeviceRequest&);
};
constexpr std::array<KnownDevice, 10> kKnown{
    {{"falcon", falcon},
     {"haply-2diy", haply},
     {"haply-inverse", attach_haply_inverse},
     {"dhd", attach_dhd},
     {"openhaptics", attach_openhaptics},
     {"inverse3", inverse3},
     {"emulated-falcon", emulated_falcon},
     {"emulated-haply", emulated_haply},
     {"emulated-inverse", emulated_inverse},
     {"emulated-inverse3", emulated_inverse3}}};

}  // namespace

std::string known_device_names() {
  std::string names;
  for (const KnownDevice& known : kKnown) {
    names += (names.empty() ? "" : ", ") + std::string(known.name);
  }
  return names;
}

bool moves_in_a_plane(const std::string& name) {
  return name == "haply-2diy" || name == "emulated-haply";
}

bool is_emulated(const std::string& name) {
  return name.starts_with("emulated-");
}

std::unique_ptr<DeviceLink> calibration_link(const DeviceRequest& request,
                                             double hung_kg) {
  if (request.name == "falcon") {
    return falcon_link(request, guarded_falcon_config(request));
  }
  if (request.name == "emulated-falcon") {
    return weighed_falcon(for_emulation(falcon_config(request)), hung_kg);
  }
  throw InputError(
      fmt::format("--device {}: has no factor to calibrate (a Haply takes torques in N "
                  "m); falcon and emulated-falcon have",
                  request.name));
}

AttachedDevice attach_emulated_haply(const DeviceRequest& request,
                                     std::size_t trace_max,
                                     std::shared_ptr<EmulatedHaply>* haply) {
  const HaplyConfig config = haply_config(request);
  return attach(
      HaplyLink(config, nullptr, nullptr).limits(), haply_rest_m,
      [=](const HandScript& hand) {
        HaplyModelConfig emulated;
        emulated.hand = hand;
        emulated.hand.surface_m.z() = 0.0;  // it cannot leave the plane
        emulated.hand.normal.z() = 0.0;
        emulated.hand.normal.normalize();
        emulated.start_m = emulated.hand.at(0.0).position_m;
        emulated.dynamics.resolution_m = 0.0;
        emulated.trace_max = trace_max;
        const auto made = std::make_shared<EmulatedHaply>(emulated, UsbFaults{});
        if (haply != nullptr) {
          *haply = made;
        }
        return EmulatedHaply::link(made, config);
      },
      plane_of(request));
}

AttachedDevice attach_emulated_inverse3(const DeviceRequest& request,
                                        std::size_t trace_max,
                                        std::shared_ptr<EmulatedInverse3>* board) {
  Inverse3Config config = inverse3_config(request);
  config.answer_s = kEmulatedAnswerS;
  return attach(Inverse3Link(config, nullptr, nullptr).limits(), inverse_rest_m(),
                [=](const HandScript& hand) {
                  Inverse3ModelConfig emulated;
                  emulated.hand = hand;
                  emulated.start_m = hand.at(0.0).position_m;
                  emulated.dynamics.resolution_m = config.resolution_m;
                  emulated.trace_max = trace_max;
                  const auto made =
                      std::make_shared<EmulatedInverse3>(emulated, UsbFaults{});
                  if (board != nullptr) {
                    *board = made;
                  }
                  return EmulatedInverse3::link(made, config);
                });
}

AttachedDevice choose_device(const DeviceRequest& request) {
  for (const KnownDevice& known : kKnown) {
    if (device_kind(request.name) == known.name) {
      return known.attach(request);
    }
  }
  throw InputError(fmt::format("--device {}: unknown device; known: {}", request.name,
                               known_device_names()));
}

std::unique_ptr<DeviceLink> probe_link(const DeviceRequest& request) {
  SimulatedDeviceConfig nobody;
  nobody.hand_n_per_m = 0.0;
  nobody.hand_n_s_per_m = 0.0;
  const std::string kind = device_kind(request.name);
  if (kind == "falcon") {
    return sign_tested(request, 3,
                       falcon_link(request, guarded_falcon_config(request)));
  }
  if (kind == "emulated-falcon") {
    return emulated_falcon_link({}, falcon_centre_m(), nobody,
                                for_emulation(falcon_config(request)));
  }
  if (kind == "inverse3") {
    return inverse3_link(request);
  }
  if (kind == "emulated-inverse3") {
    Inverse3Config config = inverse3_config(request);
    config.answer_s = kEmulatedAnswerS;
    nobody.resolution_m = config.resolution_m;
    return EmulatedInverse3::link(
        std::make_shared<EmulatedInverse3>(Inverse3ModelConfig{.dynamics = nobody},
                                           UsbFaults{}),
        config);
  }
  if (kind == "emulated-inverse") {
    return free_inverse_link(request, nobody);
  }
  if (kind == "haply-2diy") {
    return sign_tested(request, 2, haply_link(request));
  }
  if (kind == "emulated-haply") {
    nobody.resolution_m = 0.0;  // the encoders' own
    return EmulatedHaply::link(std::make_shared<EmulatedHaply>(
                                   HaplyModelConfig{.dynamics = nobody}, UsbFaults{}),
                               haply_config(request));
  }
  if (kind == "haply-inverse" || kind == "dhd" || kind == "openhaptics") {
    return driver_link(request);
  }
  throw InputError(fmt::format("--device {}: cannot be probed; these can: {}",
                               request.name, known_device_names()));
}

}  // namespace palpate
