// The Novint Falcon over USB: boot, firmware, homing, and the exchange of packets.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "runtime/device/device_link.h"
#include "runtime/device/guardian.h"
#include "runtime/usb/falcon_geometry.h"
#include "runtime/usb/falcon_packet.h"
#include "runtime/usb/usb_transport.h"

namespace palpate {

/// An image above this is none [bytes].
constexpr std::size_t kFirmwareBytesMax = 256 * 1024;

/// Reads the vendor's image. @throws InputError if the file is missing, empty or larger
/// than kFirmwareBytesMax.
[[nodiscard]] std::vector<std::uint8_t> read_firmware(const std::string& file);

constexpr UsbPair kFalconPair{
    .interface = 0, .out = 0x02, .in = 0x81, .packet_bytes = 64, .status_bytes = 2};

struct FalconConfig {
  std::vector<std::uint8_t> firmware;  ///< empty: only one that runs already
  double calibration = 1.0;            ///< [-] > 0, factor on motor commands
  double homing_s = 60.0;              ///< [s] > 0 that a person has to home it
  double answer_s = 0.002;             ///< [s] > 0 for one packet, two periods
  double force_max_n = 8.0;            ///< [N] > 0
  double damping_n_s_per_m = 0.5;      ///< [N s/m] assumed, not measured
  double coulomb_n = 0.03;             ///< [N] assumed, not measured
  /// The chip sends a reply at its last byte, not when its timer runs out. Not tried on
  /// hardware.
  bool event_character = false;
  bool guarded = false;  ///< a process of its own zeroes the force if this one dies
  std::string what = "falcon";  ///< name()
  /// Tells the person what to do; may be empty.
  std::function<void(const std::string&)> tell;
  /// Whether to give up while it boots or waits to be homed; may be empty: never.
  std::function<bool()> stopped;
};

/// After an exchange without a whole, plausible answer the next one carries no force:
/// where the tool is is then not known. It listens for as long as an answer may take,
/// so that a late answer is not taken for that of the next command.
class FalconLink : public DeviceLink {
 public:
  /// @param descriptor opens the device's usbfs file and returns it; called in open().
  /// @param release given the descriptor after close().
  FalconLink(FalconConfig config, std::function<int()> descriptor,
             std::function<void(int)> release);
  ~FalconLink() override;

  [[nodiscard]] std::string name() const override { return config_.what; }
  [[nodiscard]] DeviceLimits limits() const override;
  void open() override;
  [[nodiscard]] LinkStatus transact(const Eigen::Vector3d& force_n,
                                    Eigen::Vector3d& position_m) noexcept override;
  void close() noexcept override;
  [[nodiscard]] std::string failure() const override { return failure_; }
  [[nodiscard]] Eigen::Vector3d sent_n() const noexcept override { return sent_n_; }

 private:
  void throw_if_stopped() const;
  void start();
  void boot_and_load();
  void ask_boot_loader();
  void load();
  void run_line();
  void home();
  [[nodiscard]] bool answers();
  [[nodiscard]] LinkStatus exchange(const FalconCommand& command) noexcept;
  [[nodiscard]] std::size_t listen(std::span<std::uint8_t> bytes, double wait_s);
  [[nodiscard]] LinkStatus give_up(const char* why) noexcept;
  [[nodiscard]] LinkStatus reject(const char* why) noexcept;
  [[nodiscard]] bool plausible(const FalconReply& reply) const noexcept;

  FalconConfig config_;
  std::function<int()> descriptor_;
  std::function<void(int)> release_;
  int file_ = -1;
  std::unique_ptr<UsbTransport> usb_;
  std::unique_ptr<Guardian> guardian_;
  FalconFramer framer_;
  FalconReply reply_;
  FalconForward at_;
  Eigen::Vector3d sent_n_ = Eigen::Vector3d::Zero();
  bool known_ = false;  // at_ holds a position
  int missed_ = 0;      // exchanges without an answer, in a row: no force
  int rejected_ = 0;    // replies in a row
  const char* failure_ = "";
};

}  // namespace palpate
