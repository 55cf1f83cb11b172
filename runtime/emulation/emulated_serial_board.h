// What boards behind a serial port over USB have in common in simulation. Such boards
// have bytes that wait to be fetched, a tool and its account, and a bus that goes wrong
// between board and driver.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "runtime/emulation/emulated_falcon_board.h"
#include "runtime/emulation/emulated_usb.h"
#include "runtime/emulation/emulated_usb_device.h"

namespace palpate {

/// Takes control requests of the port's class (line coding, control lines), which are
/// of no consequence, and hands out what waits.
class SerialBoard : public UsbModel {
 public:
  [[nodiscard]] int control(const UsbSetup& setup, std::int64_t now_ns) override;
  [[nodiscard]] int receive(std::span<std::uint8_t> packet,
                            std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_ns(std::int64_t now_ns) override;

  [[nodiscard]] const SimulatedDevice& tool() const noexcept { return tool_; }
  /// The motors' account at every command.
  [[nodiscard]] const std::vector<MotorRecord>& trace() const noexcept {
    return trace_;
  }

 protected:
  /// @param split_bytes most of a reply in one packet. @param trace_max commands that
  /// trace() keeps.
  SerialBoard(const SimulatedDeviceConfig& dynamics, const HandScript& hand,
              const Eigen::Vector3d& start_m, std::size_t split_bytes,
              std::size_t trace_max);

  /// Where the tool is; the first call sets it going.
  [[nodiscard]] DeviceReading look();
  /// The tool feels that from now on, and the account is written.
  void push(const Eigen::Vector3d& force_n, std::int64_t now_ns);

  struct Port {
    SetClock clock;
    std::vector<std::uint8_t> heard;   ///< not obeyed yet
    std::deque<std::uint8_t> waiting;  ///< to be fetched ...
    std::int64_t ready_ns = 0;         ///< ... from then on
  };
  Port port;

 private:
  SimulatedDevice tool_;
  bool opened_ = false;
  std::size_t split_bytes_;
  std::size_t trace_max_;
  std::vector<MotorRecord> trace_;
};

/// A board behind a bad bus and libusb.
template <typename Board, typename Link>
class EmulatedBoard {
 public:
  template <typename Config>
  EmulatedBoard(const Config& board, const UsbFaults& bus)
      : model_(board), bus_(model_, bus) {}

  /// A driver for it, which keeps `board`.
  template <typename LinkConfig>
  [[nodiscard]] static std::unique_ptr<Link> link(
      const std::shared_ptr<EmulatedBoard>& board, const LinkConfig& config) {
    return std::make_unique<Link>(
        config,
        [board] {
          board->usb_ = std::make_unique<EmulatedUsb>(board->bus_);
          return board->usb_->descriptor();
        },
        [board](int /*descriptor*/) {
          board->kernel_driver_ = board->usb_->kernel_driver();
          board->usb_.reset();
        });
  }

  /// Only while no driver is open, or inside usb().locked().
  [[nodiscard]] const Board& model() const noexcept { return model_; }
  [[nodiscard]] const EmulatedUsb& usb() const noexcept { return *usb_; }
  [[nodiscard]] bool kernel_driver_back() const noexcept { return kernel_driver_; }

 private:
  Board model_;
  FaultyUsb bus_;
  std::unique_ptr<EmulatedUsb> usb_;
  bool kernel_driver_ = true;
};

}  // namespace palpate
