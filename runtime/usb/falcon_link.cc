#include "runtime/usb/falcon_link.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "runtime/usb/falcon_motors.h"
#include "runtime/usb/usb_guardian.h"

namespace palpate {
namespace {

constexpr double kResolutionM = 5e-5;  // one count on every leg
// A position is measured in one exchange, answered with a force by the fast loop while
// the next runs, and the force goes out with the one after it.
constexpr double kFalconDelayS = 2e-3;
constexpr int kSlewMax = 200;    // counts in an exchange: 1 m/s is about 50
constexpr int kUnheardMax = 20;  // exchanges that widen what a leg may have turned

}  // namespace

FalconLink::FalconLink(FalconConfig config, std::function<int()> descriptor,
                       std::function<void(int)> release)
    : config_(std::move(config)),
      descriptor_(std::move(descriptor)),
      release_(std::move(release)) {}

FalconLink::~FalconLink() {
  close();
}

DeviceLimits FalconLink::limits() const {
  return {.damping_n_s_per_m = config_.damping_n_s_per_m,
          .coulomb_n = config_.coulomb_n,
          .resolution_m = kResolutionM,
          .delay_s = kFalconDelayS,
          .hold_s = kUsualHoldS,
          .force_max_n = config_.force_max_n};
}

void FalconLink::open() {
  close();
  failure_ = "";
  known_ = false;
  missed_ = 0;
  rejected_ = 0;
  sent_n_.setZero();
  framer_.clear();
  reply_ = {};
  at_ = {};
  at_.position_m = falcon_centre_m();
  try {
    file_ = descriptor_();
    usb_ = std::make_unique<UsbTransport>(file_, kFalconPair);
    start();
    home();
    if (config_.guarded) {
      guardian_ = std::make_unique<Guardian>(file_, zero_falcon, kGuardianPatienceS);
    }
  } catch (...) {
    close();
    throw;
  }
}

LinkStatus FalconLink::give_up(const char* why) noexcept {
  failure_ = why;
  return LinkStatus::kLost;
}

// A stale or garbled reply may look whole: the legs cannot jump. An exchange that was
// missed took up to two periods.
bool FalconLink::plausible(const FalconReply& reply) const noexcept {
  if (!known_) {
    return true;
  }
  const int unheard = std::clamp(missed_ - rejected_, 0, kUnheardMax);
  const int slew_max = kSlewMax * (1 + 2 * unheard);
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::abs(reply.encoder[i] - reply_.encoder[i]) > slew_max) {
      return false;
    }
  }
  return true;
}

LinkStatus FalconLink::exchange(const FalconCommand& command) noexcept {
  usb_->drop_received();
  framer_.clear();
  const std::int64_t deadline_ns = deadline_ns_after(config_.answer_s);
  UsbStatus status = usb_->send(encode(command), deadline_ns);
  bool answered = false;
  while (status == UsbStatus::kOk) {
    std::uint8_t byte = 0;
    std::size_t got = 0;
    status = usb_->receive({&byte, 1}, got, deadline_ns);
    const auto packet = got == 1 ? framer_.add(byte) : std::nullopt;
    const auto reply = packet ? decode_reply(*packet) : std::nullopt;
    if (!reply) {
      continue;
    }
    if (!plausible(*reply)) {
      return reject("its encoders jump");
    }
    reply_ = *reply;
    answered = true;
    // After a miss, replies to older commands may come first: the newest until the
    // deadline counts.
    if (missed_ == 0) {
      break;
    }
  }
  if (status == UsbStatus::kLost) {
    return give_up("unplugged, or its wire is broken");
  }
  if (!answered) {
    ++missed_;
    return LinkStatus::kMissed;
  }
  missed_ = 0;
  return LinkStatus::kOk;
}

LinkStatus FalconLink::reject(const char* why) noexcept {
  ++missed_;
  return ++rejected_ > kRejectedMax ? give_up(why) : LinkStatus::kMissed;
}

LinkStatus FalconLink::transact(const Eigen::Vector3d& force_n,
                                Eigen::Vector3d& position_m) noexcept {
  if (guardian_ != nullptr && !guardian_->beat()) {
    return give_up("its guardian process is gone or had to step in");
  }
  FalconCommand command{.motor = {}, .leds = kFalconGreen, .homing = true};
  Eigen::Vector3d wanted = force_n;
  const double length = wanted.norm();
  if (length > config_.force_max_n) {
    wanted *= config_.force_max_n / length;
  }
  sent_n_.setZero();
  // Motors turn only with a known pose and a zero. sent_n_ is the force of the motors'
  // whole steps, which is less than what is wanted where they saturate.
  if (known_ && missed_ == 0 && reply_.homed == kFalconAllHomed) {
    command.motor = motors_for(wanted, at_.pose.rates, config_.calibration).command;
    sent_n_ = force_of(command.motor, at_.pose.rates, config_.calibration);
    command.leds = length > 0.0 ? kFalconBlue : kFalconGreen;
  }
  const LinkStatus status = exchange(command);
  if (status != LinkStatus::kOk) {
    return status;
  }
  if (reply_.homed != kFalconAllHomed) {
    return give_up("it forgot its zero; home it again");
  }
  // From the last position, so that one or two steps do.
  const FalconForward found = forward(angles_of(reply_.encoder), at_.position_m);
  if (!found.converged) {
    return reject("its encoders fit no position");
  }
  at_ = found;
  known_ = true;
  rejected_ = 0;
  position_m = found.position_m;
  return LinkStatus::kOk;
}

void FalconLink::close() noexcept {
  if (usb_ != nullptr && !usb_->lost()) {
    for (int i = 0; i < 3; ++i) {  // the first may be lost
      if (exchange({.motor = {}, .leds = 0, .homing = true}) != LinkStatus::kMissed) {
        break;
      }
    }
  }
  usb_.reset();
  guardian_.reset();  // while the file is open
  if (file_ >= 0) {
    release_(file_);
    file_ = -1;
  }
}

}  // namespace palpate
