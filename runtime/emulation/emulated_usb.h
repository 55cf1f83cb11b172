// Makes a model of a USB device look to libusb like an open file of the kernel's usbfs,
// in this process. The emulation needs no root and no kernel module, and runs the same
// libusb code as with hardware.
//
// The program's ioctl() is interposed: requests to the emulator's descriptor are
// answered here, all others go on to the next ioctl() in line. Only a program that uses
// this class links it in.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include "runtime/emulation/emulated_usb_device.h"

struct usbdevfs_urb;

namespace palpate {

class EmulatedUsb {
 public:
  /// The model is called under a lock, by the threads that use the descriptor. A thread
  /// of its own calls it, too, and completes transfers when their time has come.
  /// @throws DeviceError if the system gives no descriptor.
  explicit EmulatedUsb(UsbModel& model);
  ~EmulatedUsb();
  EmulatedUsb(const EmulatedUsb&) = delete;
  EmulatedUsb& operator=(const EmulatedUsb&) = delete;

  /// For libusb_wrap_sys_device, once; closed by the destructor.
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }

  /// The kernel's own driver is bound to the interface.
  [[nodiscard]] bool kernel_driver() const;

  /// Runs `look` while nothing moves.
  template <typename Look>
  auto locked(const Look& look) const {
    const std::lock_guard lock(mutex_);
    return look();
  }

  /// What an ioctl on the descriptor returns; negative: an errno.
  [[nodiscard]] int answer(unsigned long request, void* argument);

 private:
  // An IN transfer, and since when the bus asks the device for it.
  struct Waiting {
    usbdevfs_urb* urb = nullptr;
    std::int64_t since_ns = 0;
  };

  [[nodiscard]] int submit(usbdevfs_urb& urb);
  [[nodiscard]] int discard(usbdevfs_urb* urb);
  [[nodiscard]] int reap(void* argument);
  void complete(usbdevfs_urb& urb, int result);
  void complete_due(std::int64_t now_ns);
  void become_pollable();
  void run();

  UsbModel& model_;
  int descriptor_ = -1;
  int ready_ = -1;  // an eventfd that can be written while something is done
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Waiting> pending_;  // by submission
  std::deque<usbdevfs_urb*> done_;
  bool kernel_driver_ = true;
  bool end_ = false;
  std::thread thread_;
};

}  // namespace palpate
