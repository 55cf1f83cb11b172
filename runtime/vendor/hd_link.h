// 3D Systems' Touch and Touch X through OpenHaptics' libHD, which the user has. Names
// and constants: mikelitu/pyOpenHaptics.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "runtime/device/device_link.h"
#include "runtime/vendor/shared_library.h"

namespace palpate {

struct HdConfig {
  std::string library = "libHD.so";
  std::string device{};      ///< as in the vendor's set-up; empty: the default one
  double answer_s = 0.02;    ///< [s] > 0 for one tick of the library
  double force_max_n = 3.0;  ///< [N] > 0; the library's nominal one, if less
  double damping_n_s_per_m = 0.2;  ///< [N s/m] assumed, not measured
  double coulomb_n = 0.1;          ///< [N] assumed, not measured
  double resolution_m = 5.5e-5;    ///< [m] Touch's, by its data sheet (450 dpi)
  std::string what = "openhaptics";
};

/// The library calls back a thousand times a second, in a thread of its own. There the
/// force is given and the position taken; transact() waits for the next time. A force
/// that nobody renews for 20 ms is zero there; and the library clamps and ramps forces
/// as it always does. How the stylus is turned turns the tool, where the library says a
/// rotation when it is opened. Whatever it has on its stack of errors ends the link.
class HdLink : public DeviceLink {
 public:
  explicit HdLink(HdConfig config) : config_(std::move(config)) {}
  ~HdLink() override;

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
  struct Error {
    unsigned code = 0;
    int internal = 0;
    unsigned device = 0;
  };
  using Callback = unsigned (*)(void*);
  struct Functions {
    unsigned (*init)(const char*) = nullptr;
    void (*disable_device)(unsigned) = nullptr;
    void (*enable)(unsigned) = nullptr;
    void (*start)() = nullptr;
    void (*stop)() = nullptr;
    unsigned long (*schedule)(Callback, void*, unsigned short) = nullptr;
    void (*unschedule)(unsigned long) = nullptr;
    void (*begin)(unsigned) = nullptr;
    void (*end)(unsigned) = nullptr;
    void (*get)(unsigned, double*) = nullptr;
    void (*set)(unsigned, const double*) = nullptr;
    Error (*error)() = nullptr;
    const char* (*error_text)(unsigned) = nullptr;
    unsigned (*calibration)() = nullptr;  // may be missing
  };

  void load();
  void start();
  void throw_error(const char* step);
  void tick() noexcept;
  [[nodiscard]] LinkStatus give_up(const char* why) noexcept;

  HdConfig config_;
  std::unique_ptr<SharedLibrary> library_;
  Functions hd_;
  unsigned device_ = 0;
  bool open_ = false;
  bool scheduled_ = false;
  unsigned long task_ = 0;
  int missed_ = 0;
  Eigen::Vector3d sent_n_ = Eigen::Vector3d::Zero();
  bool turned_ = false;
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  const char* failure_ = "";

  std::mutex mutex_;  // what follows: shared with the library's thread
  std::condition_variable ticked_;
  std::uint64_t ticks_ = 0;
  std::int64_t wanted_ns_ = 0;
  Eigen::Vector3d wanted_n_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d position_m_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d said_ = Eigen::Matrix3d::Zero();  // of the transform
  unsigned error_ = 0;
};

}  // namespace palpate
