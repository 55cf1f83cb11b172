#include "runtime/usb/inverse3_link.h"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/usb/haply_axes.h"
#include "runtime/usb/usb_guardian.h"

namespace palpate {
namespace {

constexpr double kInverse3DelayS = 5e-4;
constexpr double kQuietS = 0.003;  // after which nothing late is expected
constexpr int kMissedMax = 20;
// In one exchange: 30 m/s in a millisecond, no hand's. [m]
constexpr double kMoveMaxM = 0.03;

}  // namespace

Inverse3Link::Inverse3Link(Inverse3Config config, std::function<int()> descriptor,
                           std::function<void(int)> release)
    : config_(std::move(config)),
      descriptor_(std::move(descriptor)),
      release_(std::move(release)) {}

Inverse3Link::~Inverse3Link() {
  close();
}

DeviceLimits Inverse3Link::limits() const {
  return {.damping_n_s_per_m = config_.damping_n_s_per_m,
          .coulomb_n = config_.coulomb_n,
          .resolution_m = config_.resolution_m,
          .delay_s = kInverse3DelayS,
          .hold_s = kUsualHoldS,
          .force_max_n = config_.force_max_n};
}

void Inverse3Link::open() {
  close();
  failure_ = "";
  known_ = false;
  placed_ = false;
  missed_ = 0;
  rejected_ = 0;
  sent_n_.setZero();
  framer_.clear();
  try {
    file_ = descriptor_();
    usb_ = std::make_unique<UsbTransport>(file_, config_.pair);
    wake_up();
    if (config_.guarded) {
      guardian_ = std::make_unique<Guardian>(file_, zero_inverse3, kGuardianPatienceS);
    }
  } catch (...) {
    close();
    throw;
  }
}

// Awake is what answers a zero force, too: what it says at the wake-up differs.
void Inverse3Link::wake_up() {
  constexpr std::array kWake{kInverse3Wake};
  for (int i = 0; i < config_.wake_tries; ++i) {
    if (config_.stopped && config_.stopped()) {
      throw Interrupted();
    }
    quieten();
    std::array<std::uint8_t, 64> answer{};
    std::size_t got = 0;
    const bool awake =
        usb_->send(kWake, deadline_ns_after(config_.wake_s)) == UsbStatus::kOk &&
        usb_->receive(answer, got, deadline_ns_after(config_.wake_s)) ==
            UsbStatus::kOk &&
        answer[0] == kInverse3Wake;
    if (awake) {
      quieten();
      if (exchange(Eigen::Vector3d::Zero()) == LinkStatus::kOk) {
        return;
      }
    }
    if (usb_->lost()) {
      throw DeviceError(config_.what + ": unplugged while it woke up");
    }
  }
  throw DeviceError(fmt::format(
      "{}: does not wake up ({} tries); is it an Inverse3, with its power supply, and "
      "does neither Haply's service nor ModemManager hold it?",
      config_.what, config_.wake_tries));
}

LinkStatus Inverse3Link::give_up(const char* why) noexcept {
  failure_ = why;
  return LinkStatus::kLost;
}

// Listens until nothing comes any more.
void Inverse3Link::quieten() noexcept {
  constexpr int kPacketsMax = 64;
  std::array<std::uint8_t, 64> ignored{};
  std::size_t got = 0;
  int packets = 0;
  while (packets < kPacketsMax &&
         usb_->receive(ignored, got, deadline_ns_after(kQuietS)) == UsbStatus::kOk) {
    ++packets;
  }
  framer_.clear();
}

LinkStatus Inverse3Link::reject() noexcept {
  known_ = false;
  framer_.clear();
  return ++rejected_ > kRejectedMax ? give_up("its answers are none, or its tool jumps")
                                    : LinkStatus::kMissed;
}

LinkStatus Inverse3Link::await_state() noexcept {
  const std::int64_t deadline_ns = deadline_ns_after(config_.answer_s);
  for (;;) {
    std::array<std::uint8_t, 1> byte{};
    std::size_t got = 0;
    const UsbStatus status = usb_->receive(byte, got, deadline_ns);
    if (status == UsbStatus::kLost) {
      return give_up("unplugged, or its wire is broken");
    }
    if (status != UsbStatus::kOk) {
      known_ = false;
      return ++missed_ > kMissedMax ? give_up("answers no more") : LinkStatus::kMissed;
    }
    // Byte by byte: the framer finds where a state ends.
    const Inverse3Framer::Found found = framer_.take(byte[0]);
    if (found == Inverse3Framer::Found::kNonsense) {
      return reject();
    }
    if (found == Inverse3Framer::Found::kState) {
      const auto there = decode_inverse3_position(framer_.state());
      if (!there) {
        return reject();
      }
      const Eigen::Vector3d position_m = from_haply(*there);
      // A state that is whole and wrong would move the tool anywhere; while nothing is
      // heard the tool may go on.
      if (placed_ && (position_m - position_m_).norm() > kMoveMaxM * (1 + missed_)) {
        return reject();
      }
      position_m_ = position_m;
      placed_ = true;
      known_ = true;
      missed_ = 0;
      rejected_ = 0;
      return LinkStatus::kOk;
    }
  }
}

bool Inverse3Link::send(const Eigen::Vector3d& force_n) noexcept {
  return usb_->send(encode_inverse3_force(to_haply(force_n)),
                    deadline_ns_after(config_.answer_s)) != UsbStatus::kLost;
}

// The board keeps the last force while the line is listened to: zero goes first.
LinkStatus Inverse3Link::exchange(const Eigen::Vector3d& force_n) noexcept {
  bool there = true;
  if (!known_) {
    there = send(Eigen::Vector3d::Zero());
    quieten();
  }
  return there && send(force_n) ? await_state()
                                : give_up("unplugged, or its wire is broken");
}

LinkStatus Inverse3Link::transact(const Eigen::Vector3d& force_n,
                                  Eigen::Vector3d& position_m) noexcept {
  if (guardian_ != nullptr && !guardian_->beat()) {
    return give_up("its guardian process is gone or had to step in");
  }
  sent_n_.setZero();
  if (known_ && force_n.allFinite()) {
    const double length = force_n.norm();
    sent_n_ =
        force_n * (length > config_.force_max_n ? config_.force_max_n / length : 1.0);
  }
  const LinkStatus status = exchange(sent_n_);
  if (status == LinkStatus::kOk) {
    position_m = position_m_;
  }
  return status;
}

void Inverse3Link::close() noexcept {
  if (usb_ != nullptr && !usb_->lost()) {
    for (int i = 0; i < 3; ++i) {  // the first may be lost
      if (exchange(Eigen::Vector3d::Zero()) != LinkStatus::kMissed) {
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
