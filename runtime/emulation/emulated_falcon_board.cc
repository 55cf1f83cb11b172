#include "runtime/emulation/emulated_falcon_board.h"

#include <algorithm>

#include "runtime/usb/falcon_geometry.h"
#include "runtime/usb/falcon_motors.h"

namespace palpate {
namespace {

constexpr std::uint16_t kBootDivisor = 0x4138;
constexpr std::uint16_t kLoadDivisor = 0x0015;
constexpr std::uint16_t kRunDivisor = 0x0002;
constexpr std::array<std::uint8_t, 3> kQuestion{0x0A, 0x43, 0x0D};
constexpr std::array<std::uint8_t, 4> kAnswer{0x0A, 0x44, 0x2C, 0x0D};
constexpr std::uint8_t kLoadMark = 0x41;

}  // namespace

FalconModel::FalconModel(const FalconModelConfig& config)
    : config_(config),
      tool_(config.dynamics, config.hand, clock_, {.position_m = config.start_m}),
      running_(config.loaded) {
  trace_.reserve(config.trace_max);
}

void FalconModel::set_dtr(bool high) {
  if (high && !dtr_) {
    running_ = false;
    loading_ = false;
    homed_ = false;
    homing_since_ns_ = -1;
    command_ = {};
    image_.clear();
    heard_.clear();
  }
  dtr_ = high;
}

void FalconModel::take(std::uint8_t byte, std::uint16_t divisor, std::int64_t now_ns,
                       std::vector<std::uint8_t>& answer) {
  // The line's divisor of 3 MHz says what the byte is: 312.5 (9600 baud) greets, 21
  // loads the firmware, 2 (1.5 Mbaud) commands.
  clock_.set(now_ns);
  if (!running_ && divisor == kBootDivisor) {
    boot(byte, answer);
  } else if (!running_ && divisor == kLoadDivisor) {
    load(byte, answer);
  } else if (divisor == kRunDivisor) {
    running_ =
        running_ || std::equal(image_.begin(), image_.end(), kEmulatedFirmware.begin(),
                               kEmulatedFirmware.end());
    const auto packet = running_ ? framer_.add(byte) : std::nullopt;
    const auto command = packet ? decode_command(*packet) : std::nullopt;
    if (command) {
      const FalconReply fresh = obey(*command, now_ns);
      const bool stale =
          config_.stale_every > 0 && commands_ % config_.stale_every == 0;
      const FalconPacket reply = encode(stale ? last_ : fresh);
      last_ = fresh;
      const WrongReplies& wrong = config_.wrong;
      if (commands_ < wrong.from || commands_ >= wrong.from + wrong.count) {
        answer.assign(reply.begin(), reply.end());
      } else if (wrong.fault != ReplyFault::kMissing) {
        const FalconPacket bad = spoilt(reply);
        answer.assign(bad.begin(), bad.end());
      }
      if (commands_ == 1) {
        first_ = reply;
      }
    }
  }
}

FalconPacket FalconModel::spoilt(FalconPacket reply) {
  switch (config_.wrong.fault) {
    case ReplyFault::kStale:
      return first_;
    case ReplyFault::kJump:
      reply[3] = static_cast<std::uint8_t>('A' + ((reply[3] - 'A') ^ 8));  // by 2048
      return reply;
    default:
      for (std::uint8_t& byte : reply) {
        byte = static_cast<std::uint8_t>(random_() & 0xFF);
      }
      return reply;
  }
}

void FalconModel::keep(double force_n, std::int64_t now_ns) {
  if (trace_.size() < config_.trace_max) {
    trace_.push_back({.time_ns = now_ns,
                      .force_n = force_n,
                      .work_j = tool_.rendered_work_j(),
                      .path_m = tool_.path_m(),
                      .squared_speed_m2_per_s = tool_.squared_speed_m2_per_s()});
  }
}

void FalconModel::boot(std::uint8_t byte, std::vector<std::uint8_t>& answer) {
  heard_.push_back(byte);
  const std::size_t n = kQuestion.size();
  if (heard_.size() >= n && std::equal(heard_.end() - static_cast<std::ptrdiff_t>(n),
                                       heard_.end(), kQuestion.begin())) {
    heard_.clear();
    if (config_.zero_before_answer) {
      answer.push_back(0);
    }
    answer.insert(answer.end(), kAnswer.begin(), kAnswer.end());
  }
}

void FalconModel::load(std::uint8_t byte, std::vector<std::uint8_t>& answer) {
  if (!loading_) {
    loading_ = byte == kLoadMark;
    if (loading_) {
      answer.push_back(kLoadMark);
    }
    return;
  }
  const bool wrong = config_.echo_errors > 0 &&
                     static_cast<std::int64_t>(image_.size()) == config_.echo_error_at;
  config_.echo_errors -= wrong ? 1 : 0;
  image_.push_back(byte);
  answer.push_back(static_cast<std::uint8_t>(wrong ? byte ^ 1 : byte));
}

FalconReply FalconModel::obey(const FalconCommand& command, std::int64_t now_ns) {
  if (!opened_) {
    tool_.open();
    opened_ = true;
  }
  ++commands_;
  if (command.homing && homing_since_ns_ < 0) {
    homing_since_ns_ = now_ns;
  }
  if (!homed_ && homing_since_ns_ >= 0 && config_.homing_ns >= 0 &&
      now_ns - homing_since_ns_ >= config_.homing_ns) {
    homed_ = true;
  }
  command_ = command;
  const bool driven = command.motor != std::array<std::int16_t, 3>{};
  driven_unhomed_ = driven_unhomed_ || (driven && !homed_);
  DeviceReading at;
  static_cast<void>(tool_.read(at));
  FalconPose pose;
  if (!inverse(tool_.motion().position_m, pose)) {
    static_cast<void>(tool_.write(Eigen::Vector3d::Zero()));  // beyond its stops
    keep(0.0, now_ns);
    return last_;
  }
  const Eigen::Vector3d force_n =
      config_.motor_gain * force_of(command.motor, pose.rates, 1.0);
  static_cast<void>(tool_.write(force_n));
  keep(force_n.norm(), now_ns);
  FalconReply reply{.encoder = counts_of(pose.theta1),
                    .buttons = 0,
                    .homed = homed_ ? kFalconAllHomed : std::uint8_t{0}};
  for (std::size_t i = 0; i < 3 && !homed_; ++i) {
    reply.encoder[i] = static_cast<std::int16_t>(reply.encoder[i] + config_.offset[i]);
  }
  return reply;
}

}  // namespace palpate
