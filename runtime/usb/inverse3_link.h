// Haply's Inverse3 over USB, without Haply's service and its checks: a CDC-ACM board
// that takes forces [N] and answers with positions.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "runtime/device/device_link.h"
#include "runtime/device/guardian.h"
#include "runtime/usb/inverse3_packet.h"
#include "runtime/usb/usb_transport.h"

namespace palpate {

/// Of the Teensy boards that such devices are made with; not read from one.
constexpr UsbPair kInverse3Pair{
    .interface = 1, .out = 0x03, .in = 0x84, .packet_bytes = 64};
constexpr std::uint16_t kInverse3Vendor = 0x16C0;
constexpr std::uint16_t kInverse3Product = 0x0483;  // of any such board

struct Inverse3Config {
  UsbPair pair = kInverse3Pair;
  double answer_s = 0.005;         ///< [s] > 0 for one state
  double wake_s = 0.3;             ///< [s] > 0 for one answer to a wake-up
  int wake_tries = 20;             ///< >= 1; boards are known to be slow
  double force_max_n = 5.0;        ///< [N] > 0
  double damping_n_s_per_m = 0.5;  ///< [N s/m] assumed, not measured
  double coulomb_n = 0.03;         ///< [N] assumed, not measured
  double resolution_m = 5e-5;      ///< [m] assumed, not measured
  bool guarded = false;            ///< as FalconConfig's
  std::string what = "inverse3";
  std::function<bool()> stopped{};  ///< while it wakes up; empty: never
};

/// Nothing is known of a watchdog in the board: the last force is taken to stay. Every
/// way out sends zero, and the thread that transacts is its watchdog
/// (threaded_device.h). After an exchange without an answer, or with what is none, the
/// next exchange begins with zero force. That exchange waits until the line is quiet,
/// and asks again.
class Inverse3Link : public DeviceLink {
 public:
  /// @param descriptor and release as FalconLink's.
  Inverse3Link(Inverse3Config config, std::function<int()> descriptor,
               std::function<void(int)> release);
  ~Inverse3Link() override;

  [[nodiscard]] std::string name() const override { return config_.what; }
  [[nodiscard]] DeviceLimits limits() const override;
  void open() override;
  [[nodiscard]] LinkStatus transact(const Eigen::Vector3d& force_n,
                                    Eigen::Vector3d& position_m) noexcept override;
  [[nodiscard]] Eigen::Vector3d sent_n() const noexcept override { return sent_n_; }
  void close() noexcept override;
  [[nodiscard]] std::string failure() const override { return failure_; }

 private:
  void wake_up();
  void quieten() noexcept;
  [[nodiscard]] bool send(const Eigen::Vector3d& force_n) noexcept;
  [[nodiscard]] LinkStatus exchange(const Eigen::Vector3d& force_n) noexcept;
  [[nodiscard]] LinkStatus await_state() noexcept;
  [[nodiscard]] LinkStatus reject() noexcept;
  [[nodiscard]] LinkStatus give_up(const char* why) noexcept;

  Inverse3Config config_;
  std::function<int()> descriptor_;
  std::function<void(int)> release_;
  int file_ = -1;
  std::unique_ptr<UsbTransport> usb_;
  std::unique_ptr<Guardian> guardian_;
  Inverse3Framer framer_;
  Eigen::Vector3d position_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d sent_n_ = Eigen::Vector3d::Zero();
  bool known_ = false;   // the latest command was answered
  bool placed_ = false;  // position_m_ is of this session
  int missed_ = 0;       // in a row
  int rejected_ = 0;
  const char* failure_ = "";
};

}  // namespace palpate
