#include "runtime/usb/usb_devices.h"

#include <algorithm>
#include <array>
#include <memory>
#include <span>

#include <fmt/format.h>
#include <libusb-1.0/libusb.h>

namespace palpate {
namespace {

constexpr std::uint16_t kNovintVendor = 0x0403;  // FTDI's, with a product of Novint's
constexpr std::uint16_t kFalconProduct = 0xCB48;

struct ContextDeleter {
  void operator()(libusb_context* context) const { libusb_exit(context); }
};

struct ListDeleter {
  void operator()(libusb_device** list) const { libusb_free_device_list(list, 1); }
};

struct ConfigDeleter {
  void operator()(libusb_config_descriptor* config) const {
    libusb_free_config_descriptor(config);
  }
};

// CDC-ACM: a communication interface of the abstract control model.
bool offers_serial_port(libusb_device* device) {
  constexpr std::uint8_t kAbstractControlModel = 2;
  libusb_config_descriptor* raw = nullptr;
  if (libusb_get_active_config_descriptor(device, &raw) != LIBUSB_SUCCESS) {
    return false;
  }
  const std::unique_ptr<libusb_config_descriptor, ConfigDeleter> config(raw);
  for (const libusb_interface& interface :
       std::span(config->interface, config->bNumInterfaces)) {
    for (const libusb_interface_descriptor& setting :
         std::span(interface.altsetting,
                   static_cast<std::size_t>(interface.num_altsetting))) {
      if (setting.bInterfaceClass == LIBUSB_CLASS_COMM &&
          setting.bInterfaceSubClass == kAbstractControlModel) {
        return true;
      }
    }
  }
  return false;
}

// "1-4.1": bus 1, port 4 of the root, port 1 of the hub there.
std::string path_of(libusb_device* device) {
  std::array<std::uint8_t, 7> port{};
  const int count =
      libusb_get_port_numbers(device, port.data(), static_cast<int>(port.size()));
  std::string path;
  for (int i = 0; i < count; ++i) {
    path += fmt::format("{}{}", i == 0 ? "" : ".", port[static_cast<std::size_t>(i)]);
  }
  return path.empty() ? "" : fmt::format("{}-{}", libusb_get_bus_number(device), path);
}

std::string text_of(libusb_device_handle* handle, std::uint8_t index) {
  std::array<unsigned char, 256> text{};
  const int count =
      index == 0 ? 0
                 : libusb_get_string_descriptor_ascii(handle, index, text.data(),
                                                      static_cast<int>(text.size()));
  return {text.begin(), text.begin() + std::max(count, 0)};
}

void try_to_open(libusb_device* device, std::uint8_t serial_number, UsbDevice& found) {
  libusb_device_handle* handle = nullptr;
  const int result = libusb_open(device, &handle);
  if (result == LIBUSB_SUCCESS) {
    found.access = UsbAccess::kOk;
    found.serial_number = text_of(handle, serial_number);
    libusb_close(handle);
    return;
  }
  found.failure = libusb_strerror(static_cast<libusb_error>(result));
  found.access = result == LIBUSB_ERROR_ACCESS ? UsbAccess::kPermission
                 : result == LIBUSB_ERROR_BUSY ? UsbAccess::kBusy
                                               : UsbAccess::kFailed;
}

std::string advice(const UsbDevice& device) {
  switch (device.access) {
    case UsbAccess::kOk:
      return "ready";
    case UsbAccess::kPermission:
      return fmt::format(
          "no permission; allow it by a udev rule: SUBSYSTEM==\"usb\", "
          "ATTR{{idVendor}}==\"{:04x}\", ATTR{{idProduct}}==\"{:04x}\", "
          "TAG+=\"uaccess\"",
          device.vendor, device.product);
    case UsbAccess::kBusy:
      return "in use by another program";
    case UsbAccess::kFailed:
      break;
  }
  return "cannot be opened: " + device.failure;
}

}  // namespace

std::string haptic_device_name(std::uint16_t vendor, std::uint16_t product) {
  return vendor == kNovintVendor && product == kFalconProduct ? "Novint Falcon" : "";
}

UsbReport find_usb_devices() {
  UsbReport report;
  libusb_context* raw_context = nullptr;
  const int started = libusb_init(&raw_context);
  if (started != LIBUSB_SUCCESS) {
    report.failure = libusb_strerror(static_cast<libusb_error>(started));
    return report;
  }
  const std::unique_ptr<libusb_context, ContextDeleter> context(raw_context);
  libusb_device** raw_list = nullptr;
  const ssize_t count = libusb_get_device_list(context.get(), &raw_list);
  if (count < 0) {
    report.failure = libusb_strerror(static_cast<libusb_error>(count));
    return report;
  }
  const std::unique_ptr<libusb_device*, ListDeleter> list(raw_list);
  report.seen = static_cast<int>(count);
  for (libusb_device* device : std::span(raw_list, static_cast<std::size_t>(count))) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device, &descriptor) != LIBUSB_SUCCESS) {
      continue;
    }
    UsbDevice found{.vendor = descriptor.idVendor,
                    .product = descriptor.idProduct,
                    .bus = libusb_get_bus_number(device),
                    .address = libusb_get_device_address(device),
                    .serial = offers_serial_port(device)};
    if (found.serial || !haptic_device_name(found.vendor, found.product).empty()) {
      found.path = path_of(device);
      try_to_open(device, descriptor.iSerialNumber, found);
      report.devices.push_back(found);
    }
  }
  return report;
}

std::string udev_rules() {
  return fmt::format(
      "# /etc/udev/rules.d/70-palpate.rules; then: udevadm control --reload && udevadm "
      "trigger\n"
      "# Novint Falcon\n"
      "SUBSYSTEM==\"usb\", ATTR{{idVendor}}==\"{:04x}\", "
      "ATTR{{idProduct}}==\"{:04x}\", "
      "TAG+=\"uaccess\"\n"
      "# Haply Inverse3, and any other Teensy board; ModemManager must leave it alone\n"
      "SUBSYSTEM==\"usb\", ATTR{{idVendor}}==\"16c0\", ATTR{{idProduct}}==\"0483\", "
      "TAG+=\"uaccess\", ENV{{ID_MM_DEVICE_IGNORE}}=\"1\"\n"
      "# A Haply 2diy's board has the numbers of its maker: palpate-run devices shows "
      "them\n",
      kNovintVendor, kFalconProduct);
}

std::string describe(const UsbReport& report) {
  if (!report.failure.empty()) {
    return fmt::format("no haptic device: the USB bus cannot be read ({})\n",
                       report.failure);
  }
  std::string text;
  bool known = false;
  for (const UsbDevice& device : report.devices) {
    const std::string name = haptic_device_name(device.vendor, device.product);
    known = known || !name.empty();
    text += fmt::format(
        "{:04x}:{:04x} bus {} address {}: {}: {}\n", device.vendor, device.product,
        device.bus, device.address,
        name.empty() ? "serial board, may be a Haply (its numbers do not tell)" : name,
        advice(device));
  }
  if (!known) {
    text += fmt::format("no known haptic device is attached ({} USB device{} seen)\n",
                        report.seen, report.seen == 1 ? "" : "s");
  }
  return text;
}

}  // namespace palpate
