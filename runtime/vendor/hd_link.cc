#include "runtime/vendor/hd_link.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/device/device_turn.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

constexpr unsigned kBadHandle = 0xFFFFFFFF;
constexpr unsigned kForceOutput = 0x4000;
constexpr unsigned kCalibrated = 0x5000;
constexpr unsigned kPositionMm = 0x2050;
constexpr unsigned kTransform = 0x2052;
constexpr unsigned kForceN = 0x2700;
constexpr unsigned kNominalForceN = 0x2603;
constexpr unsigned short kPriority = 0xFFFF;
constexpr unsigned kGoOn = 1;
constexpr std::int64_t kSilentNs = 20'000'000;
constexpr int kMissedMax = 10;
constexpr double kHdDelayS = 1e-3;
constexpr double kMillimetre = 1e-3;

}  // namespace

HdLink::~HdLink() {
  close();
}

DeviceLimits HdLink::limits() const {
  return {.damping_n_s_per_m = config_.damping_n_s_per_m,
          .coulomb_n = config_.coulomb_n,
          .resolution_m = config_.resolution_m,
          .delay_s = kHdDelayS,
          .hold_s = kUsualHoldS,
          .force_max_n = config_.force_max_n};
}

void HdLink::load() {
  library_ = std::make_unique<SharedLibrary>(config_.library, "3D Systems");
  library_->find("hdInitDevice", hd_.init);
  library_->find("hdDisableDevice", hd_.disable_device);
  library_->find("hdEnable", hd_.enable);
  library_->find("hdStartScheduler", hd_.start);
  library_->find("hdStopScheduler", hd_.stop);
  library_->find("hdScheduleAsynchronous", hd_.schedule);
  library_->find("hdUnschedule", hd_.unschedule);
  library_->find("hdBeginFrame", hd_.begin);
  library_->find("hdEndFrame", hd_.end);
  library_->find("hdGetDoublev", hd_.get);
  library_->find("hdSetDoublev", hd_.set);
  library_->find("hdGetError", hd_.error);
  library_->find("hdGetErrorString", hd_.error_text);
  library_->find_if_there("hdCheckCalibration", hd_.calibration);
}

void HdLink::throw_error(const char* step) {
  const Error error = hd_.error();
  if (error.code != 0) {
    throw DeviceError(fmt::format("{}: {} (error 0x{:04X})", step,
                                  hd_.error_text(error.code), error.code));
  }
}

void HdLink::open() {
  close();
  failure_ = "";
  try {
    start();
  } catch (const DeviceError& error) {
    close();
    throw DeviceError(fmt::format("{}: {}", config_.what, error.what()));
  }
}

void HdLink::start() {
  if (library_ == nullptr) {
    load();
  }
  device_ = hd_.init(config_.device.empty() ? nullptr : config_.device.c_str());
  throw_error("no device");
  if (device_ == kBadHandle) {
    throw DeviceError("no device");
  }
  open_ = true;
  if (hd_.calibration != nullptr && hd_.calibration() != kCalibrated) {
    throw DeviceError(
        "not calibrated: put its stylus into its inkwell, or calibrate it by the "
        "vendor's set-up");
  }
  double nominal_n = config_.force_max_n;
  hd_.get(kNominalForceN, &nominal_n);
  if (nominal_n > 0.0) {
    config_.force_max_n = std::min(config_.force_max_n, nominal_n);
  }
  {
    const std::lock_guard lock(mutex_);
    ticks_ = 0;
    error_ = 0;
    wanted_ns_ = 0;
    missed_ = 0;
  }
  task_ = hd_.schedule(
      [](void* self) {
        static_cast<HdLink*>(self)->tick();
        return kGoOn;
      },
      this, kPriority);
  scheduled_ = true;
  hd_.enable(kForceOutput);
  hd_.start();
  throw_error("its scheduler does not start");
  turned_ = false;  // the first transform says whether it is one
  Eigen::Vector3d ignored;
  LinkStatus status = LinkStatus::kMissed;
  while (status == LinkStatus::kMissed) {
    status = transact(Eigen::Vector3d::Zero(), ignored);
  }
  if (status == LinkStatus::kLost) {
    throw DeviceError(failure_);
  }
  const std::lock_guard lock(mutex_);
  if (const auto turn = exact_turn(said_)) {
    turned_ = true;
    turn_ = *turn;
  }
}

// In the library's thread.
void HdLink::tick() noexcept {
  MonotonicClock clock;
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  {
    const std::lock_guard lock(mutex_);
    if (error_ == 0 && clock.now_ns() - wanted_ns_ < kSilentNs) {
      force_n = wanted_n_;
    }
  }
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();
  Eigen::Matrix4d transform = Eigen::Matrix4d::Zero();  // by columns, as the library's
  hd_.begin(device_);
  hd_.get(kPositionMm, position_mm.data());
  hd_.get(kTransform, transform.data());
  hd_.set(kForceN, force_n.data());
  hd_.end(device_);
  const Error error = hd_.error();
  const std::lock_guard lock(mutex_);
  error_ = error_ != 0 ? error_ : error.code;
  position_m_ = kMillimetre * position_mm;
  said_ = transform.topLeftCorner<3, 3>();
  ++ticks_;
  ticked_.notify_one();
}

// Called with the mutex held.
LinkStatus HdLink::give_up(const char* why) noexcept {
  wanted_n_.setZero();
  sent_n_.setZero();
  failure_ = why;
  return LinkStatus::kLost;
}

LinkStatus HdLink::transact(const Eigen::Vector3d& force_n,
                            Eigen::Vector3d& position_m) noexcept {
  if (!open_ || *failure_ != '\0') {
    return LinkStatus::kLost;
  }
  sent_n_.setZero();
  if (force_n.allFinite()) {
    const double length = force_n.norm();
    sent_n_ =
        force_n * (length > config_.force_max_n ? config_.force_max_n / length : 1.0);
  }
  MonotonicClock clock;
  std::unique_lock lock(mutex_);
  wanted_n_ = sent_n_;
  wanted_ns_ = clock.now_ns();
  // Its position is new; the force acts from then on, or from the tick after that.
  const std::uint64_t wanted = ticks_ + 1;
  const bool ticked =
      ticked_.wait_for(lock, std::chrono::duration<double>(config_.answer_s), [&] {
        return ticks_ >= wanted;
      });
  if (error_ != 0) {
    return give_up(hd_.error_text(error_));
  }
  if (!ticked) {
    wanted_n_.setZero();
    sent_n_.setZero();
    return ++missed_ > kMissedMax ? give_up("its scheduler has stopped")
                                  : LinkStatus::kMissed;
  }
  missed_ = 0;
  if (turned_) {
    const auto turn = exact_turn(said_);
    if (!turn) {
      return give_up("its library says an orientation that is none");
    }
    turn_ = *turn;
  }
  position_m = position_m_;
  return LinkStatus::kOk;
}

void HdLink::close() noexcept {
  if (!open_) {
    return;
  }
  if (scheduled_) {
    {
      std::unique_lock lock(mutex_);
      wanted_n_.setZero();
      const std::uint64_t last = ticks_ + 2;
      ticked_.wait_for(lock, std::chrono::duration<double>(config_.answer_s), [&] {
        return ticks_ >= last;
      });
    }
    hd_.stop();
    hd_.unschedule(task_);
    scheduled_ = false;
  }
  hd_.disable_device(device_);
  open_ = false;
}

}  // namespace palpate
