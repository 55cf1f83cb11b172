#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "runtime/command/commands.h"
#include "runtime/usb/usb_devices.h"

namespace palpate {
namespace {

nlohmann::json devices_json(const UsbReport& report) {
  nlohmann::json devices = nlohmann::json::array();
  for (const UsbDevice& device : report.devices) {
    devices.push_back({{"name", haptic_device_name(device.vendor, device.product)},
                       {"vendor", device.vendor},
                       {"product", device.product},
                       {"bus", device.bus},
                       {"address", device.address},
                       {"path", device.path},
                       {"serial_number", device.serial_number},
                       {"serial", device.serial},
                       {"usable", device.access == UsbAccess::kOk},
                       {"failure", device.failure}});
  }
  return {
      {"devices", devices}, {"usb_devices", report.seen}, {"failure", report.failure}};
}

}  // namespace

void add_devices_command(Command app) {
  Command command =
      app.add_subcommand("devices", "List the haptic devices that are attached.");
  const auto json = std::make_shared<bool>(false);
  const auto udev = std::make_shared<bool>(false);
  command.add_flag("--json", *json, "Print the report for programs");
  command.add_flag("--udev", *udev, "Print the rules that permit their use");
  command.callback([json, udev] {
    if (*udev) {
      fmt::print("{}", udev_rules());
      return;
    }
    const UsbReport report = find_usb_devices();
    fmt::print("{}",
               *json ? json_text(devices_json(report), 2) + "\n" : describe(report));
  });
}

}  // namespace palpate
