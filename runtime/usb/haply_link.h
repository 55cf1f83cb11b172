// The Haply 2diy over USB. The 2diy is a CDC-ACM board with two motors that move a
// pantograph in a plane, the x-y plane of the device's frame (z = 0).
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "runtime/device/device_link.h"
#include "runtime/device/guardian.h"
#include "runtime/usb/haply_packet.h"
#include "runtime/usb/pantograph.h"
#include "runtime/usb/usb_transport.h"

namespace palpate {

constexpr std::uint8_t kHaplyId = HaplySetup{}.id;
constexpr UsbPair kHaplyPair{
    .interface = 1, .out = 0x02, .in = 0x83, .packet_bytes = 64};

struct HaplyConfig {
  HaplySetup setup{};
  PantographLinks links{};
  UsbPair pair = kHaplyPair;
  double answer_s = 0.002;         ///< [s] > 0 for one reply
  double force_max_n = 2.0;        ///< [N] > 0
  double damping_n_s_per_m = 0.1;  ///< [N s/m] assumed, not measured
  double coulomb_n = 0.02;         ///< [N] assumed, not measured
  bool guarded = false;            ///< as FalconConfig's
  std::string what = "haply-2diy";
  /// Asks a person to put the arms against their stops and waits until that is done;
  /// the set-up takes where they stand then for setup.offset_deg. Called by every
  /// open(), also after a reconnection. May throw where nobody answers.
  std::function<void(const std::string&)> ask;
};

/// The board keeps the last torque for ever: every way out sends zero, and the thread
/// that transacts is its watchdog (threaded_device.h). There is no force where the free
/// links are nearly in line, none out of the plane, and none after an exchange without
/// an answer. The next exchange listens until no late answer can come, and takes the
/// last.
class HaplyLink : public DeviceLink {
 public:
  /// @param descriptor and release as FalconLink's. @throws InputError for links that
  /// cannot be.
  HaplyLink(HaplyConfig config, std::function<int()> descriptor,
            std::function<void(int)> release);
  ~HaplyLink() override;

  [[nodiscard]] std::string name() const override { return config_.what; }
  [[nodiscard]] DeviceLimits limits() const override;
  void open() override;
  [[nodiscard]] LinkStatus transact(const Eigen::Vector3d& force_n,
                                    Eigen::Vector3d& position_m) noexcept override;
  void close() noexcept override;
  [[nodiscard]] std::string failure() const override { return failure_; }
  [[nodiscard]] Eigen::Vector3d sent_n() const noexcept override { return sent_n_; }

 private:
  [[nodiscard]] LinkStatus exchange(const std::array<double, 2>& torque_nm) noexcept;
  [[nodiscard]] LinkStatus give_up(const char* why) noexcept;

  HaplyConfig config_;
  std::function<int()> descriptor_;
  std::function<void(int)> release_;
  int file_ = -1;
  std::unique_ptr<UsbTransport> usb_;
  std::unique_ptr<Guardian> guardian_;
  PantographPose pose_;
  Eigen::Vector3d sent_n_ = Eigen::Vector3d::Zero();
  bool known_ = false;
  bool placed_ = false;  // pose_ holds a position of this session
  int missed_ = 0;       // exchanges without a position, in a row
  int rejected_ = 0;
  const char* failure_ = "";
};

}  // namespace palpate
