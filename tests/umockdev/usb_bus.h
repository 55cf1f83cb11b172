// A USB bus without hardware for whole programs: umockdev's sysfs and device nodes, and
// behind each node a model of a device. What runs under umockdev's preloaded library,
// this process and its children, enumerates and opens as on a real bus.
//
// The models, and the answers to usbfs requests, live in a thread of umockdev's in this
// process. Requests come to the thread through a socket, with the memory that they
// point at.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <umockdev.h>

#include "runtime/emulation/emulated_usb_device.h"

namespace palpate {

/// Gives up a reference of GLib's.
struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
};
struct UnrefData {
  void operator()(UMockdevIoctlData* data) const { umockdev_ioctl_data_unref(data); }
};
using IoctlData = std::unique_ptr<UMockdevIoctlData, UnrefData>;

/// Where a device is plugged in.
struct UsbPlace {
  int port = 1;     ///< of the root hub of bus 1
  int address = 2;  ///< [2, 127] on bus 1
};

class UsbSocket;

/// An empty bus 1 with its root hub. One at a time in a process.
class UsbBus {
 public:
  UsbBus();
  ~UsbBus();
  UsbBus(const UsbBus&) = delete;
  UsbBus& operator=(const UsbBus&) = delete;

  /// The model stays the caller's, and lives as long as the bus. @param descriptors as
  /// UsbModel::descriptors().
  UsbSocket& plug(UsbModel& model, const std::vector<std::uint8_t>& descriptors,
                  const UsbPlace& place);

  /// Takes the device from the bus: out of sysfs, its node away, and whoever has it
  /// open is told.
  void unplug(UsbSocket& socket);

  /// This process runs under umockdev's preloaded library.
  [[nodiscard]] bool seen() const;

  /// The folder that programs see as the root.
  [[nodiscard]] std::string root() const;

 private:
  void add(const std::string& text);

  std::unique_ptr<UMockdevTestbed, Unref> bed_;
  std::vector<std::unique_ptr<UsbSocket>> sockets_;
};

/// A device node, and what is under way on it.
class UsbSocket {
 public:
  UsbSocket(UsbModel& model, std::vector<std::uint8_t> descriptors,
            const UsbPlace& place);
  ~UsbSocket();
  UsbSocket(const UsbSocket&) = delete;
  UsbSocket& operator=(const UsbSocket&) = delete;

  /// The kernel's own driver is bound to the interface.
  [[nodiscard]] bool kernel_driver() const;

  /// Runs `look` while nothing moves.
  template <typename Look>
  auto locked(const Look& look) const {
    const std::lock_guard lock(mutex_);
    return look();
  }

  /// As seen by programs.
  [[nodiscard]] std::string node() const;
  [[nodiscard]] std::string sysfs() const;

 private:
  friend class UsbBus;
  struct Transfer {
    IoctlData urb;
    std::int64_t since_ns = 0;
  };

  static gboolean on_ioctl(UMockdevIoctlBase* handler, UMockdevIoctlClient* client,
                           UsbSocket* self);
  static gboolean on_read(UMockdevIoctlBase* handler, UMockdevIoctlClient* client,
                          UsbSocket* self);
  static void on_open(UMockdevIoctlBase* handler, UMockdevIoctlClient* client,
                      UsbSocket* self);
  static void on_close(UMockdevIoctlBase* handler, UMockdevIoctlClient* client,
                       UsbSocket* self);

  [[nodiscard]] int answer(unsigned long request, UMockdevIoctlData* argument);
  [[nodiscard]] int answer_control(UMockdevIoctlData* argument);
  [[nodiscard]] int answer_bulk(UMockdevIoctlData* argument);
  [[nodiscard]] int submit(UMockdevIoctlData* argument);
  [[nodiscard]] int discard(UMockdevIoctlData* argument);
  [[nodiscard]] int reap(UMockdevIoctlData* argument);
  void complete(IoctlData urb, int result);
  void complete_due(std::int64_t now_ns);
  void unplug();

  UsbModel& model_;
  std::vector<std::uint8_t> descriptors_;
  UsbPlace place_;
  std::unique_ptr<UMockdevIoctlBase, Unref> handler_;
  mutable std::mutex mutex_;
  std::deque<Transfer> pending_;  // by submission
  std::deque<IoctlData> done_;
  std::size_t read_ = 0;  // of the descriptors
  bool kernel_driver_ = true;
  bool gone_ = false;
};

}  // namespace palpate
