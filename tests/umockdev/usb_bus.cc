#include "tests/umockdev/usb_bus.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include "runtime/realtime/clock.h"
#include "runtime/realtime/real_time.h"

namespace palpate {
namespace {

std::int64_t now_ns() {
  MonotonicClock clock;
  return clock.now_ns();
}

// What a program's pointer at `offset` points at: a copy, written back with the answer.
IoctlData at(UMockdevIoctlData* data, std::size_t offset, std::size_t bytes) {
  IoctlData found(umockdev_ioctl_data_resolve(data, offset, bytes, nullptr));
  if (found == nullptr) {
    throw std::runtime_error("no memory behind a usbfs request");
  }
  return found;
}

template <typename T>
T& as(const IoctlData& data) {
  return *reinterpret_cast<T*>(data->data);
}

IoctlData buffer_of(UMockdevIoctlData* urb) {
  const auto& fields = *reinterpret_cast<usbdevfs_urb*>(urb->data);
  return at(urb, offsetof(usbdevfs_urb, buffer),
            static_cast<std::size_t>(fields.buffer_length));
}

UsbSetup setup_of(const std::uint8_t* bytes) {
  const auto word = [bytes](int i) {
    return static_cast<std::uint16_t>(bytes[i] | bytes[i + 1] << 8);
  };
  return {.request_type = bytes[0],
          .request = bytes[1],
          .value = word(2),
          .index = word(4)};
}

std::string hex_of(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += fmt::format("{:02X}", byte);
  }
  return text;
}

// A device as umockdev takes it; `path` under /sys.
std::string entry(const std::string& path, int address,
                  std::span<const std::uint8_t> descriptors) {
  return fmt::format(
      "P: {0}\nN: bus/usb/001/{1:03}={2}\nE: SUBSYSTEM=usb\nE: DRIVER=usb\n"
      "E: BUSNUM=001\nE: DEVNUM={1:03}\nE: DEVNAME=/dev/bus/usb/001/{1:03}\n"
      "E: DEVTYPE=usb_device\nA: busnum=1\\n\nA: devnum={1}\\n\nA: speed=12\\n\n"
      "A: bConfigurationValue=1\\n\nH: descriptors={2}\n",
      path, address, hex_of(descriptors));
}

std::vector<std::uint8_t> root_hub() {
  return {18, 1, 0x00, 0x02, 9, 0, 1, 64,   0x6B, 0x1D, 2, 0, 0, 6, 0, 0, 0, 1,  //
          9,  2, 25,   0,    1, 1, 0, 0xE0, 0,                                   //
          9,  4, 0,    0,    1, 9, 0, 0,    0,                                   //
          7,  5, 0x81, 3,    4, 0, 12};
}

}  // namespace

UsbBus::UsbBus() : bed_(umockdev_testbed_new()) {
  add(entry("/devices/usb1", 1, root_hub()));
}

UsbBus::~UsbBus() {
  for (const auto& socket : sockets_) {
    umockdev_testbed_detach_ioctl(bed_.get(), socket->node().c_str(), nullptr);
  }
}

void UsbBus::add(const std::string& text) {
  GError* error = nullptr;
  if (umockdev_testbed_add_from_string(bed_.get(), text.c_str(), &error) == FALSE) {
    const std::string why = error->message;
    g_error_free(error);
    throw std::runtime_error("umockdev: " + why);
  }
}

UsbSocket& UsbBus::plug(UsbModel& model, const std::vector<std::uint8_t>& descriptors,
                        const UsbPlace& place) {
  sockets_.push_back(std::make_unique<UsbSocket>(model, descriptors, place));
  UsbSocket& socket = *sockets_.back();
  GError* error = nullptr;
  if (umockdev_testbed_attach_ioctl(bed_.get(), socket.node().c_str(),
                                    socket.handler_.get(), &error) == FALSE) {
    const std::string why = error->message;
    g_error_free(error);
    throw std::runtime_error("umockdev: " + why);
  }
  add(entry(fmt::format("/devices/usb1/1-{}", place.port), place.address, descriptors));
  return socket;
}

void UsbBus::unplug(UsbSocket& socket) {
  umockdev_testbed_uevent(bed_.get(), socket.sysfs().c_str(), "remove");
  umockdev_testbed_remove_device(bed_.get(), socket.sysfs().c_str());
  socket.unplug();
}

bool UsbBus::seen() const {
  return umockdev_in_mock_environment() != FALSE;
}

std::string UsbBus::root() const {
  gchar* raw = umockdev_testbed_get_root_dir(bed_.get());
  const std::string root = raw;
  g_free(raw);
  return root;
}

UsbSocket::UsbSocket(UsbModel& model, std::vector<std::uint8_t> descriptors,
                     const UsbPlace& place)
    : model_(model),
      descriptors_(std::move(descriptors)),
      place_(place),
      handler_(umockdev_ioctl_base_new()) {
  const auto connect = [this](const char* signal, GCallback call) {
    g_signal_connect_after(handler_.get(), signal, call, this);
  };
  connect("handle-ioctl", G_CALLBACK(&UsbSocket::on_ioctl));
  connect("handle-read", G_CALLBACK(&UsbSocket::on_read));
  connect("client-connected", G_CALLBACK(&UsbSocket::on_open));
  connect("client-vanished", G_CALLBACK(&UsbSocket::on_close));
}

UsbSocket::~UsbSocket() {
  g_signal_handlers_disconnect_by_data(handler_.get(), this);
}

std::string UsbSocket::node() const {
  return fmt::format("/dev/bus/usb/001/{:03}", place_.address);
}

std::string UsbSocket::sysfs() const {
  return fmt::format("/sys/devices/usb1/1-{}", place_.port);
}

bool UsbSocket::kernel_driver() const {
  return locked([this] {
    return kernel_driver_;
  });
}

gboolean UsbSocket::on_ioctl(UMockdevIoctlBase* /*handler*/,
                             UMockdevIoctlClient* client, UsbSocket* self) {
  const std::lock_guard lock(self->mutex_);
  const int result = self->answer(umockdev_ioctl_client_get_request(client),
                                  umockdev_ioctl_client_get_arg(client));
  umockdev_ioctl_client_complete(client, result < 0 ? -1 : result,
                                 result < 0 ? -result : 0);
  return TRUE;
}

// The descriptors, from the begin each time that somebody has come to their end.
gboolean UsbSocket::on_read(UMockdevIoctlBase* /*handler*/, UMockdevIoctlClient* client,
                            UsbSocket* self) {
  const std::lock_guard lock(self->mutex_);
  UMockdevIoctlData* const to = umockdev_ioctl_client_get_arg(client);
  const std::size_t count = std::min(static_cast<std::size_t>(to->data_len),
                                     self->descriptors_.size() - self->read_);
  std::copy_n(self->descriptors_.begin() + static_cast<std::ptrdiff_t>(self->read_),
              count, to->data);
  self->read_ = count == 0 ? 0 : self->read_ + count;
  umockdev_ioctl_client_complete(client, static_cast<glong>(count), 0);
  return TRUE;
}

// In umockdev's thread, which is to answer at once: hardware is not late.
void UsbSocket::on_open(UMockdevIoctlBase* /*handler*/, UMockdevIoctlClient* /*client*/,
                        UsbSocket* /*self*/) {
  static_cast<void>(request_real_time(-1));
}

// What a program leaves under way when it ends or closes the node.
void UsbSocket::on_close(UMockdevIoctlBase* /*handler*/,
                         UMockdevIoctlClient* /*client*/, UsbSocket* self) {
  const std::lock_guard lock(self->mutex_);
  self->pending_.clear();
  self->done_.clear();
}

int UsbSocket::answer(unsigned long request, UMockdevIoctlData* argument) {
  if (gone_ && request != USBDEVFS_REAPURBNDELAY) {
    return -ENODEV;
  }
  switch (request) {
    case USBDEVFS_CONNECTINFO:
      as<usbdevfs_connectinfo>(at(argument, 0, sizeof(usbdevfs_connectinfo))) = {
          .devnum = static_cast<unsigned>(place_.address), .slow = 0};
      return 0;
    case USBDEVFS_GET_SPEED:
      return 2;  // full speed
    case USBDEVFS_GET_CAPABILITIES:
      as<std::uint32_t>(at(argument, 0, sizeof(std::uint32_t))) = 0;
      return 0;
    case USBDEVFS_CONTROL:
      return answer_control(argument);
    case USBDEVFS_DISCONNECT_CLAIM:
      kernel_driver_ = false;
      return 0;
    case USBDEVFS_IOCTL:
      if (as<usbdevfs_ioctl>(at(argument, 0, sizeof(usbdevfs_ioctl))).ioctl_code ==
          static_cast<int>(USBDEVFS_CONNECT)) {
        kernel_driver_ = true;
        return 1;
      }
      return -ENOTTY;
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_RELEASEINTERFACE:
    case USBDEVFS_CLEAR_HALT:
      return 0;
    case USBDEVFS_BULK:
      return answer_bulk(argument);
    case USBDEVFS_SUBMITURB:
      return submit(argument);
    case USBDEVFS_DISCARDURB:
      return discard(argument);
    case USBDEVFS_REAPURBNDELAY:
      return reap(argument);
    default:
      return -ENOTTY;
  }
}

int UsbSocket::answer_control(UMockdevIoctlData* argument) {
  const IoctlData data = at(argument, 0, sizeof(usbdevfs_ctrltransfer));
  const auto& control = as<usbdevfs_ctrltransfer>(data);
  if (control.bRequestType == 0x80 && control.bRequest == 0x08) {
    // The only configuration.
    as<std::uint8_t>(at(data.get(), offsetof(usbdevfs_ctrltransfer, data), 1)) = 1;
    return 1;
  }
  return -EPIPE;
}

int UsbSocket::answer_bulk(UMockdevIoctlData* argument) {
  const IoctlData data = at(argument, 0, sizeof(usbdevfs_bulktransfer));
  const auto& bulk = as<usbdevfs_bulktransfer>(data);
  const IoctlData bytes =
      at(data.get(), offsetof(usbdevfs_bulktransfer, data), bulk.len);
  return model_.send({bytes->data, bulk.len}, now_ns());
}

int UsbSocket::submit(UMockdevIoctlData* argument) {
  IoctlData data = at(argument, 0, sizeof(usbdevfs_urb));
  const auto& urb = as<usbdevfs_urb>(data);
  const IoctlData bytes = buffer_of(data.get());
  const std::int64_t now = now_ns();
  if (urb.type == USBDEVFS_URB_TYPE_CONTROL) {
    complete(std::move(data), model_.control(setup_of(bytes->data), now));
  } else if ((urb.endpoint & 0x80) != 0) {
    pending_.push_back({.urb = std::move(data), .since_ns = now});
  } else {
    const int sent =
        model_.send({bytes->data, static_cast<std::size_t>(urb.buffer_length)}, now);
    if (sent == -EAGAIN) {
      return -ENOMEM;
    }
    complete(std::move(data), sent);
  }
  return 0;
}

int UsbSocket::discard(UMockdevIoctlData* argument) {
  gulong address = 0;
  std::memcpy(&address, argument->data, sizeof address);
  const auto found = std::find_if(pending_.begin(), pending_.end(),
                                  [address](const Transfer& transfer) {
                                    return transfer.urb->client_addr == address;
                                  });
  if (found == pending_.end()) {
    return -EINVAL;
  }
  IoctlData urb = std::move(found->urb);
  pending_.erase(found);
  complete(std::move(urb), -ENOENT);
  return 0;
}

int UsbSocket::reap(UMockdevIoctlData* argument) {
  complete_due(now_ns());
  if (done_.empty()) {
    return gone_ ? -ENODEV : -EAGAIN;
  }
  const IoctlData urb = std::move(done_.front());
  done_.pop_front();
  const IoctlData pointer = at(argument, 0, sizeof(void*));
  umockdev_ioctl_data_set_ptr(pointer.get(), 0, urb.get());
  return 0;
}

void UsbSocket::complete(IoctlData data, int result) {
  auto& urb = as<usbdevfs_urb>(data);
  urb.status = result >= 0 ? 0 : (result == -ENODEV ? -ESHUTDOWN : result);
  urb.actual_length = std::max(result, 0);
  done_.push_back(std::move(data));
}

void UsbSocket::complete_due(std::int64_t now) {
  while (!pending_.empty() && !gone_) {
    // submit() has the buffer here, in place of the program's.
    const auto& fields = as<usbdevfs_urb>(pending_.front().urb);
    // The bus takes a packet when it is there; the program may ask for it later.
    const std::int64_t taken_ns =
        std::min(now, std::max(model_.next_ns(now), pending_.front().since_ns));
    const int got = model_.receive({static_cast<std::uint8_t*>(fields.buffer),
                                    static_cast<std::size_t>(fields.buffer_length)},
                                   taken_ns);
    if (got == -EAGAIN) {
      return;
    }
    IoctlData urb = std::move(pending_.front().urb);
    pending_.pop_front();
    complete(std::move(urb), got);
  }
}

void UsbSocket::unplug() {
  const std::lock_guard lock(mutex_);
  gone_ = true;
  for (; !pending_.empty(); pending_.pop_front()) {
    complete(std::move(pending_.front().urb), -ENODEV);
  }
}

}  // namespace palpate
