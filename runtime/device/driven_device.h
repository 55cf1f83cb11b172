// A device whose driver is a program that runs as long as the device is open.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <sys/types.h>

#include "runtime/device/socket_device.h"

namespace palpate {

struct DriverProgram {
  std::string name{};                  ///< of the device
  DeviceLimits limits{};               ///< what is known before it is open
  std::vector<std::string> command{};  ///< program (a path), then its arguments
  double open_s = 120.0;               ///< [s] > 0 until its hello
  std::shared_ptr<const void> kept{};  ///< lives as long as the device
  std::function<bool()> stopped{};     ///< while it opens; empty: never
};

/// open() starts the program with "--descriptor N" after its arguments: N is the
/// driver's end of the socket (socket_device.h). Where the renderer is killed or hangs,
/// the guardian speaks to the driver. Where the driver is killed, the kernel closes
/// what the driver had open. Where the driver hangs, its silence is a fault, and
/// close() kills it.
class DrivenDevice : public Device {
 public:
  explicit DrivenDevice(DriverProgram program) : program_(std::move(program)) {}
  ~DrivenDevice() override;

  [[nodiscard]] std::string name() const override { return program_.name; }
  [[nodiscard]] DeviceLimits limits() const override { return program_.limits; }
  [[nodiscard]] bool measures_turns() const override { return turns_; }
  void open() override;
  [[nodiscard]] DeviceStatus read(DeviceReading& reading) noexcept override;
  [[nodiscard]] DeviceStatus write(const Eigen::Vector3d& force_n) noexcept override;
  void close() noexcept override;
  [[nodiscard]] std::string failure() const override;
  [[nodiscard]] const LinkReport* wire() const override {
    return device_ == nullptr ? &report_ : device_->wire();
  }

  /// While open; -1 otherwise.
  [[nodiscard]] pid_t driver() const noexcept { return driver_; }

 private:
  void start(int descriptor);
  void end_driver() noexcept;

  DriverProgram program_;
  std::unique_ptr<SocketDevice> device_;  // while open
  pid_t driver_ = -1;
  LinkReport report_;    // of the latest that was closed
  std::string failure_;  // its
  bool turns_ = false;   // likewise
};

}  // namespace palpate
