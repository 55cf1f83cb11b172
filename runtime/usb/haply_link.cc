#include "runtime/usb/haply_link.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/usb/usb_guardian.h"

namespace palpate {
namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180.0;
constexpr double kHaplyDelayS = 5e-4;
constexpr int kOpenTries = 10;
// An arm in one exchange: 0.3 rad in 0.5 ms are 30 m/s at the tool, no hand's. [rad]
constexpr double kTurnMax = 0.3;

}  // namespace

HaplyLink::HaplyLink(HaplyConfig config, std::function<int()> descriptor,
                     std::function<void(int)> release)
    : config_(std::move(config)),
      descriptor_(std::move(descriptor)),
      release_(std::move(release)) {
  check(config_.links);
}

HaplyLink::~HaplyLink() {
  close();
}

// One count turns a driven link by 2 pi / counts; the tool moves by about as much.
DeviceLimits HaplyLink::limits() const {
  return {.damping_n_s_per_m = config_.damping_n_s_per_m,
          .coulomb_n = config_.coulomb_n,
          .resolution_m = 2.0 * std::numbers::pi * config_.links.driven_m /
                          config_.setup.counts_per_turn,
          .delay_s = kHaplyDelayS,
          .hold_s = kUsualHoldS,
          .force_max_n = config_.force_max_n};
}

void HaplyLink::open() {
  close();
  failure_ = "";
  known_ = false;
  placed_ = false;
  missed_ = 0;
  rejected_ = 0;
  sent_n_.setZero();
  try {
    file_ = descriptor_();
    if (config_.ask) {
      config_.ask(fmt::format(
          "{}: put both arms against their stops: where they stand when it is set up "
          "counts as {:g} and {:g} degrees, and every force depends on it",
          config_.what, config_.setup.offset_deg[0], config_.setup.offset_deg[1]));
    }
    usb_ = std::make_unique<UsbTransport>(file_, config_.pair);
    // Set-up, then zero torques: a board that answers them with angles is ready.
    const auto setup = encode(config_.setup);
    for (int i = 0; i < kOpenTries; ++i) {
      if (usb_->send(setup, deadline_ns_after(0.1)) == UsbStatus::kOk &&
          exchange({0.0, 0.0}) == LinkStatus::kOk) {
        if (config_.guarded) {
          guardian_ = std::make_unique<Guardian>(file_, zero_haply, kGuardianPatienceS);
        }
        return;
      }
      if (usb_->lost()) {
        throw DeviceError(config_.what + ": unplugged while it was set up");
      }
    }
    throw DeviceError(
        fmt::format("{}: the board does not answer ({} tries); is it a Haply?",
                    config_.what, kOpenTries));
  } catch (...) {
    close();
    throw;
  }
}

LinkStatus HaplyLink::give_up(const char* why) noexcept {
  failure_ = why;
  return LinkStatus::kLost;
}

LinkStatus HaplyLink::exchange(const std::array<double, 2>& torque_nm) noexcept {
  usb_->drop_received();
  const std::int64_t deadline_ns = deadline_ns_after(config_.answer_s);
  UsbStatus status =
      usb_->send(encode_torques(config_.setup.id, torque_nm), deadline_ns);
  std::array<std::uint8_t, 3 * kHaplyReplyBytes> heard{};
  const std::size_t wanted = known_ ? kHaplyReplyBytes : heard.size();
  std::size_t count = 0;
  while (status == UsbStatus::kOk && count < wanted) {
    std::size_t got = 0;
    status = usb_->receive(std::span(heard).subspan(count, wanted - count), got,
                           deadline_ns);
    count += got;
  }
  if (status == UsbStatus::kLost) {
    return give_up("unplugged, or its wire is broken");
  }
  std::array<std::uint8_t, kHaplyReplyBytes> reply{};
  const bool whole = count > 0 && count % reply.size() == 0;
  if (whole) {
    std::copy_n(heard.begin() + static_cast<std::ptrdiff_t>(count - reply.size()),
                reply.size(), reply.begin());
  }
  const auto angles = whole ? decode_angles(config_.setup.id, reply) : std::nullopt;
  const Eigen::Vector2d theta =
      angles
          ? Eigen::Vector2d(kRadPerDegree * Eigen::Vector2d((*angles)[0], (*angles)[1]))
          : Eigen::Vector2d::Zero();
  // A reply that is whole and wrong would move the tool anywhere. Links that were not
  // heard for a while may have turned meanwhile.
  const bool jumped =
      placed_ && (theta - pose_.theta).cwiseAbs().maxCoeff() > kTurnMax * (1 + missed_);
  if (angles && !jumped && forward(config_.links, theta, pose_)) {
    known_ = true;
    placed_ = true;
    missed_ = 0;
    rejected_ = 0;
    return LinkStatus::kOk;
  }
  known_ = false;  // no force before the next whole reply
  missed_ += angles ? 0 : 1;
  return angles && ++rejected_ > kRejectedMax
             ? give_up("its angles jump or fit no position")
             : LinkStatus::kMissed;
}

LinkStatus HaplyLink::transact(const Eigen::Vector3d& force_n,
                               Eigen::Vector3d& position_m) noexcept {
  if (guardian_ != nullptr && !guardian_->beat()) {
    return give_up("its guardian process is gone or had to step in");
  }
  Eigen::Vector2d torque = Eigen::Vector2d::Zero();
  sent_n_.setZero();
  if (known_) {
    Eigen::Vector2d wanted = force_n.head<2>();
    const double length = wanted.norm();
    if (length > config_.force_max_n) {
      wanted *= config_.force_max_n / length;
    }
    torque = torques_for(pose_, wanted, kHaplyTorqueMaxNm);
    sent_n_.head<2>() = force_of(pose_, torque);
  }
  const LinkStatus status = exchange({torque[0], torque[1]});
  if (status == LinkStatus::kOk) {
    position_m << pose_.position_m, 0.0;
  }
  return status;
}

void HaplyLink::close() noexcept {
  if (usb_ != nullptr && !usb_->lost()) {
    for (int i = 0; i < 3; ++i) {  // the first may be lost
      if (exchange({0.0, 0.0}) != LinkStatus::kMissed) {
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
