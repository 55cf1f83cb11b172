#include "runtime/emulation/emulated_usb.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdarg>
#include <cstring>

#include <dlfcn.h>
#include <fcntl.h>
#include <linux/usbdevice_fs.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"
#include "runtime/realtime/real_time.h"

namespace palpate {
namespace {

constexpr std::size_t kDescriptors = 4096;
constexpr std::uint64_t kNothingDone = ~std::uint64_t{0} - 1;  // no room to write
std::array<std::atomic<EmulatedUsb*>, kDescriptors> emulated{};

// The C library's, or that of a library which was preloaded to emulate devices, too.
// Found at the start: a guardian process may call nothing that takes a lock.
using Ioctl = int (*)(int, unsigned long, ...);
const Ioctl next_ioctl = reinterpret_cast<Ioctl>(::dlsym(RTLD_NEXT, "ioctl"));

std::int64_t now_ns() {
  MonotonicClock clock;
  return clock.now_ns();
}

UsbSetup setup_of(const std::uint8_t* bytes) {
  const auto word = [bytes](int at) {
    return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
  };
  return {.request_type = bytes[0],
          .request = bytes[1],
          .value = word(2),
          .index = word(4)};
}

}  // namespace

EmulatedUsb::EmulatedUsb(UsbModel& model) : model_(model) {
  // libusb reads the descriptors first, and polls later: a file, then an eventfd.
  descriptor_ = ::memfd_create("palpate-usb", MFD_CLOEXEC);
  ready_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  const std::vector<std::uint8_t> bytes = model.descriptors();
  if (descriptor_ < 0 || ready_ < 0 || descriptor_ >= static_cast<int>(kDescriptors) ||
      ::write(descriptor_, bytes.data(), bytes.size()) !=
          static_cast<ssize_t>(bytes.size()) ||
      ::write(ready_, &kNothingDone, sizeof kNothingDone) != sizeof kNothingDone) {
    ::close(descriptor_);
    ::close(ready_);
    throw DeviceError("emulated USB device: no descriptor to be had");
  }
  emulated[static_cast<std::size_t>(descriptor_)].store(this);
  thread_ = std::thread([this] {
    run();
  });
}

EmulatedUsb::~EmulatedUsb() {
  emulated[static_cast<std::size_t>(descriptor_)].store(nullptr);
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  changed_.notify_all();
  thread_.join();
  ::close(descriptor_);
  ::close(ready_);
}

bool EmulatedUsb::kernel_driver() const {
  const std::lock_guard lock(mutex_);
  return kernel_driver_;
}

void EmulatedUsb::run() {
  static_cast<void>(request_real_time(-1));  // hardware is not late
  std::unique_lock lock(mutex_);
  while (!end_) {
    if (pending_.empty()) {
      changed_.wait(lock);
      continue;
    }
    const std::int64_t now = now_ns();
    complete_due(now);
    if (!pending_.empty()) {
      const std::int64_t wait_ns =
          std::clamp<std::int64_t>(model_.next_ns(now) - now, 5'000, 20'000'000);
      changed_.wait_for(lock, std::chrono::nanoseconds(wait_ns));
    }
  }
}

void EmulatedUsb::complete_due(std::int64_t now) {
  while (!pending_.empty()) {
    usbdevfs_urb& urb = *pending_.front().urb;
    // The bus takes a packet when it is there; this thread may come to it later.
    const std::int64_t taken_ns =
        std::min(now, std::max(model_.next_ns(now), pending_.front().since_ns));
    const int got = model_.receive({static_cast<std::uint8_t*>(urb.buffer),
                                    static_cast<std::size_t>(urb.buffer_length)},
                                   taken_ns);
    if (got == -EAGAIN) {
      return;
    }
    pending_.pop_front();
    complete(urb, got);
  }
}

void EmulatedUsb::complete(usbdevfs_urb& urb, int result) {
  urb.status = result >= 0 ? 0 : (result == -ENODEV ? -ESHUTDOWN : result);
  urb.actual_length = std::max(result, 0);
  done_.push_back(&urb);
  std::uint64_t count = 0;
  static_cast<void>(::read(ready_, &count, sizeof count));
}

int EmulatedUsb::submit(usbdevfs_urb& urb) {
  const std::int64_t now = now_ns();
  auto* const bytes = static_cast<std::uint8_t*>(urb.buffer);
  if (urb.type == USBDEVFS_URB_TYPE_CONTROL) {
    complete(urb, model_.control(setup_of(bytes), now));
    return 0;
  }
  if ((urb.endpoint & 0x80) != 0) {
    pending_.push_back({.urb = &urb, .since_ns = now});
    changed_.notify_all();
    return 0;
  }
  const int sent =
      model_.send({bytes, static_cast<std::size_t>(urb.buffer_length)}, now);
  if (sent == -EAGAIN) {
    return -ENOMEM;
  }
  complete(urb, sent);
  complete_due(now);
  changed_.notify_all();
  return 0;
}

int EmulatedUsb::discard(usbdevfs_urb* urb) {
  const auto found =
      std::find_if(pending_.begin(), pending_.end(), [urb](const Waiting& waiting) {
        return waiting.urb == urb;
      });
  if (found == pending_.end()) {
    return -EINVAL;
  }
  pending_.erase(found);
  complete(*urb, -ENOENT);
  return 0;
}

int EmulatedUsb::reap(void* argument) {
  if (done_.empty()) {
    static_cast<void>(::write(ready_, &kNothingDone, sizeof kNothingDone));
    return -EAGAIN;
  }
  usbdevfs_urb* const urb = done_.front();
  done_.pop_front();
  std::memcpy(argument, &urb, sizeof urb);
  return 0;
}

void EmulatedUsb::become_pollable() {
  ::dup3(ready_, descriptor_, O_CLOEXEC);
}

int EmulatedUsb::answer(unsigned long request, void* argument) {
  const std::lock_guard lock(mutex_);
  switch (request) {
    case USBDEVFS_CONNECTINFO:
      *static_cast<usbdevfs_connectinfo*>(argument) = {.devnum = 1, .slow = 0};
      return 0;
    case USBDEVFS_GET_SPEED:
      return 2;  // full speed
    case USBDEVFS_GET_CAPABILITIES:
      *static_cast<std::uint32_t*>(argument) = 0;
      become_pollable();
      return 0;
    case USBDEVFS_CONTROL: {
      auto& control = *static_cast<usbdevfs_ctrltransfer*>(argument);
      if (control.bRequestType == 0x80 && control.bRequest == 0x08) {
        *static_cast<std::uint8_t*>(control.data) = 1;  // the only configuration
        return 1;
      }
      return -EPIPE;
    }
    case USBDEVFS_DISCONNECT_CLAIM:
      kernel_driver_ = false;
      return 0;
    case USBDEVFS_IOCTL:
      if (static_cast<usbdevfs_ioctl*>(argument)->ioctl_code ==
          static_cast<int>(USBDEVFS_CONNECT)) {
        kernel_driver_ = true;
        return 1;
      }
      return -ENOTTY;
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_RELEASEINTERFACE:
    case USBDEVFS_CLEAR_HALT:
      return 0;
    case USBDEVFS_BULK: {
      const auto& bulk = *static_cast<usbdevfs_bulktransfer*>(argument);
      return model_.send({static_cast<std::uint8_t*>(bulk.data), bulk.len}, now_ns());
    }
    case USBDEVFS_SUBMITURB:
      return submit(*static_cast<usbdevfs_urb*>(argument));
    case USBDEVFS_DISCARDURB:
      return discard(static_cast<usbdevfs_urb*>(argument));
    case USBDEVFS_REAPURBNDELAY:
    case USBDEVFS_REAPURB:
      return reap(argument);
    default:
      return -ENOTTY;
  }
}

}  // namespace palpate

extern "C" int ioctl(int descriptor, unsigned long request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  palpate::EmulatedUsb* const usb =
      descriptor >= 0 && descriptor < static_cast<int>(palpate::kDescriptors)
          ? palpate::emulated[static_cast<std::size_t>(descriptor)].load()
          : nullptr;
  if (usb == nullptr) {
    return palpate::next_ioctl != nullptr  // else before the start
               ? palpate::next_ioctl(descriptor, request, argument)
               : static_cast<int>(::syscall(SYS_ioctl, descriptor, request, argument));
  }
  const int result = usb->answer(request, argument);
  if (result < 0) {
    errno = -result;
    return -1;
  }
  return result;
}
