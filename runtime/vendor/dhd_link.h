// Force Dimension's devices (omega, delta, sigma, lambda) through their library, which
// the user has. Names and meanings: Force Dimension's DHD as used by
// EmDash00/forcedimension_core-python and ICube-Robotics/forcedimension_ros2.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "runtime/device/device_link.h"
#include "runtime/vendor/shared_library.h"

namespace palpate {

struct DhdConfig {
  std::string library = "libdhd.so.3";
  int index = -1;                  ///< of the device; -1: the first
  double force_max_n = 8.0;        ///< [N] > 0
  double damping_n_s_per_m = 0.5;  ///< [N s/m] assumed, not measured
  double coulomb_n = 0.05;         ///< [N] assumed, not measured
  double resolution_m = 1e-5;      ///< [m] omega.3's, by its data sheet
  std::string what = "dhd";
  std::function<void(const std::string&)> tell{};
};

/// The device's own watchdog takes the force away when no command comes for 20 ms;
/// where it has none, that is said. A device with a wrist turns the tool, where the
/// library has the functions for it. Whatever the library reports ends the link by its
/// words.
class DhdLink : public DeviceLink {
 public:
  explicit DhdLink(DhdConfig config) : config_(std::move(config)) {}
  ~DhdLink() override;

  [[nodiscard]] std::string name() const override { return config_.what; }
  [[nodiscard]] DeviceLimits limits() const override;
  void open() override;
  [[nodiscard]] LinkStatus transact(const Eigen::Vector3d& force_n,
                                    Eigen::Vector3d& position_m) noexcept override;
  [[nodiscard]] Eigen::Vector3d sent_n() const noexcept override { return sent_n_; }
  [[nodiscard]] bool measures_turns() const noexcept override { return turned_; }
  [[nodiscard]] Eigen::Quaterniond turn() const noexcept override { return turn_; }
  void close() noexcept override;
  [[nodiscard]] std::string failure() const override { return failure_; }

 private:
  struct Functions {
    int (*open)() = nullptr;
    int (*open_id)(char) = nullptr;
    int (*close)(char) = nullptr;
    int (*position)(double*, double*, double*, char) = nullptr;
    int (*force)(double, double, double, char) = nullptr;
    int (*enable)(unsigned char, char) = nullptr;
    int (*watchdog)(unsigned char, char) = nullptr;
    const char* (*error)() = nullptr;
    bool (*has_wrist)(char) = nullptr;  // both may be missing
    int (*orientation)(double (*)[3], char) = nullptr;
    bool (*calibrated)(char) = nullptr;  // may be missing
  };

  void start();
  void require_calibrated() const;
  [[nodiscard]] bool push(const Eigen::Vector3d& force_n) noexcept;
  [[nodiscard]] bool take_turn() noexcept;
  [[nodiscard]] LinkStatus give_up(const char* why) noexcept;

  DhdConfig config_;
  std::unique_ptr<SharedLibrary> library_;
  Functions dhd_;
  char id_ = -1;  // < 0: not open
  Eigen::Vector3d sent_n_ = Eigen::Vector3d::Zero();
  bool turned_ = false;
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  const char* failure_ = "";
};

}  // namespace palpate
