#include "runtime/attach/driven_devices.h"

#include <charconv>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/attach/sign_test.h"
#include "runtime/inverse/inverse_link.h"
#include "runtime/vendor/dhd_link.h"
#include "runtime/vendor/hd_link.h"

namespace palpate {
namespace {

// The port behind a name's colon.
std::uint16_t port_of(const DeviceRequest& request, std::uint16_t otherwise) {
  const std::size_t colon = request.name.find(':');
  if (colon == std::string::npos) {
    return otherwise;
  }
  const std::string text = request.name.substr(colon + 1);
  unsigned port = 0;
  const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (bad != std::errc() || end != text.data() + text.size() || port < 1 ||
      port > 65535) {
    throw InputError(fmt::format("--device {}: \"{}\" is no port, must be 1 to 65535",
                                 request.name, text));
  }
  return static_cast<std::uint16_t>(port);
}

void refuse_what_inverse_has_not(const DeviceRequest& request) {
  if (!request.firmware.empty()) {
    throw InputError(
        fmt::format("--firmware {}: a {} has its own", request.firmware, request.name));
  }
  if (!request.plane.empty()) {
    throw InputError(fmt::format("--plane {}: a {} moves in all three dimensions",
                                 request.plane, request.name));
  }
  if (!request.usb.empty()) {
    throw InputError(
        fmt::format("--usb {}: the Inverse service owns the device, name "
                    "it by --device-id",
                    request.usb));
  }
}

InverseConfig inverse_config(const DeviceRequest& request) {
  refuse_what_inverse_has_not(request);
  InverseConfig config;
  config.port = port_of(request, config.port);
  config.events_port = request.events_port;
  config.device_id = request.device_id;
  config.grip_id = request.grip_id;
  config.profile = request.profile;
  config.tell = request.tell;
  return config;
}

std::vector<std::string> inverse_driver(const DeviceRequest& request,
                                        const InverseConfig& config) {
  std::vector<std::string> command{request.driver_program,
                                   "driver",
                                   "--device",
                                   fmt::format("haply-inverse:{}", config.port),
                                   "--events-port",
                                   std::to_string(config.events_port),
                                   "--profile",
                                   config.profile};
  if (!config.device_id.empty()) {
    command.insert(command.end(), {"--device-id", config.device_id});
  }
  if (!config.grip_id.empty()) {
    command.insert(command.end(), {"--grip-id", config.grip_id});
  }
  if (!request.sign_test) {
    command.emplace_back("--no-sign-test");
  }
  return command;
}

void refuse_what_vendors_have_not(const DeviceRequest& request) {
  if (!request.firmware.empty() || !request.plane.empty() || !request.usb.empty() ||
      !request.grip_id.empty()) {
    throw InputError(fmt::format(
        "--device {}: takes no --firmware, --plane, --usb or --grip-id; name it by "
        "--device-id",
        request.name));
  }
}

DhdConfig dhd_config(const DeviceRequest& request) {
  refuse_what_vendors_have_not(request);
  DhdConfig config;
  config.tell = request.tell;
  if (!request.device_id.empty()) {
    const std::string& text = request.device_id;
    const char* const end = text.data() + text.size();
    const auto [stop, bad] = std::from_chars(text.data(), end, config.index);
    if (bad != std::errc() || stop != end || config.index < 0 || config.index > 15) {
      throw InputError(fmt::format(
          "--device-id {}: of a dhd device it is a number from 0 to 15", text));
    }
  }
  return config;
}

HdConfig hd_config(const DeviceRequest& request) {
  refuse_what_vendors_have_not(request);
  HdConfig config;
  config.device = request.device_id;
  return config;
}

// By a library that the user has, in a process of its own.
AttachedDevice vendors(const DeviceRequest& request, const DeviceLimits& limits) {
  return attach_driven(limits, Eigen::Vector3d::Zero(), [=](const HandScript&) {
    DriverProgram program{
        .name = request.name,
        .limits = limits,
        .command = {request.driver_program, "driver", "--device", request.name},
        .stopped = request.stopped};
    if (!request.device_id.empty()) {
      program.command.insert(program.command.end(), {"--device-id", request.device_id});
    }
    if (!request.sign_test) {
      program.command.emplace_back("--no-sign-test");
    }
    return program;
  });
}

}  // namespace

std::string device_kind(const std::string& name) {
  return name.starts_with("haply-inverse:") ? "haply-inverse" : name;
}

std::unique_ptr<DeviceLink> sign_tested(const DeviceRequest& request, int axes,
                                        std::unique_ptr<DeviceLink> link) {
  if (!request.sign_test) {
    return link;
  }
  return std::make_unique<SignTestedLink>(
      std::move(link), SignTestOptions{.axes = axes}, request.tell, request.stopped);
}

AttachedDevice attach_haply_inverse(const DeviceRequest& request) {
  const InverseConfig config = inverse_config(request);
  const DeviceLimits limits = InverseLink(config).limits();
  return attach_driven(limits, inverse_rest_m(), [=](const HandScript&) {
    return DriverProgram{.name = "haply-inverse",
                         .limits = limits,
                         .command = inverse_driver(request, config),
                         .stopped = request.stopped};
  });
}

AttachedDevice attach_emulated_inverse(const DeviceRequest& request,
                                       const EmulatedInverseConfig& like,
                                       std::shared_ptr<EmulatedInverse>* service) {
  InverseConfig config = inverse_config(request);
  const DeviceLimits limits = InverseLink(config).limits();
  return attach_driven(limits, inverse_rest_m(), [=](const HandScript& hand) {
    EmulatedInverseConfig emulated = like;
    emulated.hand = hand;
    emulated.start_m = hand.at(0.0).position_m;
    emulated.dynamics.resolution_m = config.resolution_m;
    emulated.grip = {.normal = hand.normal};
    const auto running = std::make_shared<EmulatedInverse>(emulated);
    if (service != nullptr) {
      *service = running;
    }
    DeviceRequest driver = request;
    driver.sign_test = false;  // the hand is about to press
    InverseConfig there = config;
    there.port = running->port();
    there.events_port = running->events_port();
    return DriverProgram{.name = "emulated-inverse",
                         .limits = limits,
                         .command = inverse_driver(driver, there),
                         .kept = running,
                         .stopped = request.stopped};
  });
}

std::unique_ptr<DeviceLink> free_inverse_link(const DeviceRequest& request,
                                              SimulatedDeviceConfig dynamics) {
  InverseConfig config = inverse_config(request);
  dynamics.resolution_m = config.resolution_m;
  const auto service =
      std::make_shared<EmulatedInverse>(EmulatedInverseConfig{.dynamics = dynamics});
  config.port = service->port();
  config.events_port = service->events_port();
  config.what = request.name;
  config.kept = service;
  return std::make_unique<InverseLink>(config);
}

AttachedDevice attach_dhd(const DeviceRequest& request) {
  return vendors(request, DhdLink(dhd_config(request)).limits());
}

AttachedDevice attach_openhaptics(const DeviceRequest& request) {
  return vendors(request, HdLink(hd_config(request)).limits());
}

std::unique_ptr<DeviceLink> driver_link(const DeviceRequest& request) {
  const std::string name = device_kind(request.name);
  if (name == "haply-inverse") {
    return sign_tested(request, 3,
                       std::make_unique<InverseLink>(inverse_config(request)));
  }
  if (name == "dhd") {
    return sign_tested(request, 3, std::make_unique<DhdLink>(dhd_config(request)));
  }
  if (name == "openhaptics") {
    return sign_tested(request, 3, std::make_unique<HdLink>(hd_config(request)));
  }
  throw InputError(fmt::format(
      "driver --device {}: must be haply-inverse, dhd or openhaptics", request.name));
}

}  // namespace palpate
