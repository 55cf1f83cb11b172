#include "runtime/vendor/dhd_link.h"

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/device/device_turn.h"

namespace palpate {
namespace {

constexpr unsigned char kWatchdogSteps = 160;  // of 125 us: 20 ms
constexpr double kDhdDelayS = 1e-3;

// The library's axes: x towards the person, y right, z up. Ours: y up, z towards the
// person.
Eigen::Vector3d from_library(const Eigen::Vector3d& v) {
  return {v.y(), v.z(), v.x()};
}
Eigen::Vector3d to_library(const Eigen::Vector3d& v) {
  return {v.z(), v.x(), v.y()};
}

}  // namespace

DhdLink::~DhdLink() {
  close();
}

DeviceLimits DhdLink::limits() const {
  return {.damping_n_s_per_m = config_.damping_n_s_per_m,
          .coulomb_n = config_.coulomb_n,
          .resolution_m = config_.resolution_m,
          .delay_s = kDhdDelayS,
          .hold_s = kUsualHoldS,
          .force_max_n = config_.force_max_n};
}

void DhdLink::open() {
  close();
  failure_ = "";
  try {
    start();
  } catch (const DeviceError& error) {
    close();
    throw DeviceError(fmt::format("{}: {}", config_.what, error.what()));
  }
}

void DhdLink::start() {
  if (library_ == nullptr) {
    library_ = std::make_unique<SharedLibrary>(config_.library, "Force Dimension");
    library_->find("dhdOpen", dhd_.open);
    library_->find("dhdOpenID", dhd_.open_id);
    library_->find("dhdClose", dhd_.close);
    library_->find("dhdGetPosition", dhd_.position);
    library_->find("dhdSetForce", dhd_.force);
    library_->find("dhdEnableForce", dhd_.enable);
    library_->find("dhdSetWatchdog", dhd_.watchdog);
    library_->find("dhdErrorGetLastStr", dhd_.error);
    library_->find_if_there("dhdHasWrist", dhd_.has_wrist);
    library_->find_if_there("dhdGetOrientationFrame", dhd_.orientation);
    library_->find_if_there("drdIsInitialized", dhd_.calibrated);
  }
  const int id =
      config_.index < 0 ? dhd_.open() : dhd_.open_id(static_cast<char>(config_.index));
  if (id < 0) {
    throw DeviceError(fmt::format("no device: {}", dhd_.error()));
  }
  id_ = static_cast<char>(id);
  require_calibrated();
  turned_ =
      dhd_.has_wrist != nullptr && dhd_.orientation != nullptr && dhd_.has_wrist(id_);
  // Zero is commanded before forces are enabled.
  Eigen::Vector3d ignored;
  if (transact(Eigen::Vector3d::Zero(), ignored) != LinkStatus::kOk ||
      dhd_.enable(1, id_) < 0) {
    throw DeviceError(*failure_ != '\0' ? failure_ : dhd_.error());
  }
  if (dhd_.watchdog(kWatchdogSteps, id_) < 0 && config_.tell) {
    config_.tell(fmt::format(
        "{}: the device has no watchdog of its own ({}): if its driver is killed, it "
        "may keep its force",
        config_.what, dhd_.error()));
  }
}

// Before that, positions are those of another pose.
void DhdLink::require_calibrated() const {
  constexpr const char* kHow =
      "put its calibration pole into its pit, until its status light stops blinking";
  if (dhd_.calibrated != nullptr && !dhd_.calibrated(id_)) {
    throw DeviceError(fmt::format("not calibrated: {}", kHow));
  }
  if (dhd_.calibrated == nullptr && config_.tell) {
    config_.tell(
        fmt::format("{}: its library does not say whether the device is calibrated; if "
                    "it is not, {}",
                    config_.what, kHow));
  }
}

bool DhdLink::push(const Eigen::Vector3d& force_n) noexcept {
  const Eigen::Vector3d there = to_library(force_n);
  return dhd_.force(there.x(), there.y(), there.z(), id_) >= 0;  // > 0: a remark
}

// False, and the link has failed, where the library fails or says no rotation.
bool DhdLink::take_turn() noexcept {
  double row[3][3] = {};
  if (dhd_.orientation(row, id_) < 0) {
    static_cast<void>(give_up(dhd_.error()));
    return false;
  }
  Eigen::Matrix3d there;
  there << row[0][0], row[0][1], row[0][2], row[1][0], row[1][1], row[1][2], row[2][0],
      row[2][1], row[2][2];
  const auto turn = exact_turn(there);
  if (!turn) {
    static_cast<void>(give_up("its library says an orientation that is none"));
    return false;
  }
  turn_.w() = turn->w();
  turn_.vec() = from_library(turn->vec());
  return true;
}

// @param why the library's own words, which it keeps, or ours.
LinkStatus DhdLink::give_up(const char* why) noexcept {
  if (*failure_ == '\0') {
    failure_ = why;
    static_cast<void>(push(Eigen::Vector3d::Zero()));
  }
  sent_n_.setZero();
  return LinkStatus::kLost;
}

LinkStatus DhdLink::transact(const Eigen::Vector3d& force_n,
                             Eigen::Vector3d& position_m) noexcept {
  if (id_ < 0 || *failure_ != '\0') {
    return LinkStatus::kLost;
  }
  sent_n_.setZero();
  if (force_n.allFinite()) {
    const double length = force_n.norm();
    sent_n_ =
        force_n * (length > config_.force_max_n ? config_.force_max_n / length : 1.0);
  }
  Eigen::Vector3d there = Eigen::Vector3d::Zero();
  if (!push(sent_n_) || dhd_.position(&there.x(), &there.y(), &there.z(), id_) < 0) {
    return give_up(dhd_.error());
  }
  if (turned_ && !take_turn()) {
    return LinkStatus::kLost;
  }
  position_m = from_library(there);
  return LinkStatus::kOk;
}

void DhdLink::close() noexcept {
  if (id_ >= 0) {
    static_cast<void>(push(Eigen::Vector3d::Zero()));
    dhd_.enable(0, id_);
    dhd_.close(id_);
    id_ = -1;
  }
}

}  // namespace palpate
