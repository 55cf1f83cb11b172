#include "runtime/attach/usb_choice.h"

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

bool lies_at(const UsbDevice& device, const std::string& where) {
  return where.empty() || where == fmt::format("{}:{}", device.bus, device.address) ||
         where == device.path || where == device.serial_number;
}

void check_access(const UsbDevice& device, const std::string& what) {
  switch (device.access) {
    case UsbAccess::kOk:
      return;
    case UsbAccess::kPermission:
      throw DeviceError(
          fmt::format("{}: no permission to open it ({}); palpate-run devices --udev "
                      "prints the rule that gives it",
                      what, place_of(device)));
    case UsbAccess::kBusy:
      throw DeviceError(
          fmt::format("{}: in use by another program ({})", what, place_of(device)));
    case UsbAccess::kFailed:
      throw DeviceError(fmt::format("{}: cannot be opened ({}): {}", what,
                                    place_of(device), device.failure));
  }
}

}  // namespace

std::string place_of(const UsbDevice& device) {
  std::string place = fmt::format("{}:{}", device.bus, device.address);
  if (!device.path.empty()) {
    place += ", port " + device.path;
  }
  if (!device.serial_number.empty()) {
    place += ", serial number " + device.serial_number;
  }
  return place;
}

UsbDevice choose_usb_device(const UsbReport& report, const std::string& what,
                            const std::string& where,
                            bool (*is_meant)(const UsbDevice&)) {
  const UsbDevice* found = nullptr;
  int count = 0;
  std::string places;
  std::string others;
  for (const UsbDevice& device : report.devices) {
    if (!is_meant(device)) {
      continue;
    }
    std::string& list = lies_at(device, where) ? places : others;
    list += (list.empty() ? "" : "; ") + place_of(device);
    if (lies_at(device, where)) {
      found = &device;
      ++count;
    }
  }
  if (found == nullptr) {
    throw DeviceError(
        fmt::format("{}: none is attached{} ({} USB devices seen{}{}{}{})", what,
                    where.empty() ? "" : " at " + where, report.seen,
                    others.empty() ? "" : "; elsewhere: ", others,
                    report.failure.empty() ? "" : "; ", report.failure));
  }
  if (count > 1) {
    throw DeviceError(fmt::format("{}: {} are attached; choose one by --usb: {}", what,
                                  count, places));
  }
  check_access(*found, what);
  return *found;
}

}  // namespace palpate
