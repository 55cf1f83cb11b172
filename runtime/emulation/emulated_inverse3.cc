#include "runtime/emulation/emulated_inverse3.h"

#include <algorithm>
#include <cerrno>

#include "runtime/usb/haply_axes.h"

namespace palpate {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

}  // namespace

Inverse3Model::Inverse3Model(const Inverse3ModelConfig& config)
    : config_(config),
      tool_(config.dynamics, config.hand, clock_, {.position_m = config.start_m}) {
  trace_.reserve(config.trace_max);
}

// Line coding and control lines are of no consequence.
int Inverse3Model::control(const UsbSetup& setup, std::int64_t /*now_ns*/) {
  return (setup.request_type & 0x60) == 0x20 ? 0 : -EPIPE;
}

int Inverse3Model::send(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  clock_.set(now_ns);
  ready_ns_ = now_ns + config_.answer_ns;
  heard_.insert(heard_.end(), bytes.begin(), bytes.end());
  while (!heard_.empty()) {
    const bool force = heard_[0] == kInverse3Force;
    const std::size_t length = force ? kInverse3ForceBytes : 1;
    if (heard_.size() < length) {
      break;
    }
    if (force) {
      obey(now_ns);
    } else if (heard_[0] == kInverse3Wake) {
      wake();
    }
    heard_.erase(heard_.begin(), heard_.begin() + static_cast<std::ptrdiff_t>(length));
  }
  return static_cast<int>(bytes.size());
}

void Inverse3Model::wake() {
  if (wakes_++ >= config_.deaf) {
    waiting_.push_back(kInverse3Wake);
    waiting_.insert(waiting_.end(), config_.newer ? 16 : kInverse3WakeBytes - 1, 7);
  }
}

void Inverse3Model::obey(std::int64_t now_ns) {
  if (wakes_ <= config_.deaf) {
    return;
  }
  if (!opened_) {
    tool_.open();
    opened_ = true;
  }
  std::array<std::uint8_t, kInverse3ForceBytes> command{};
  std::copy_n(heard_.begin(), command.size(), command.begin());
  DeviceReading at;
  static_cast<void>(tool_.read(at));
  const Inverse3State state = encode_inverse3_state(
      to_haply(at.position_m), to_haply(tool_.motion().velocity_m_per_s));
  static_cast<void>(tool_.write(from_haply(decode_inverse3_force(command))));
  if (trace_.size() < config_.trace_max) {
    trace_.push_back(motor_record(tool_, now_ns));
  }
  ++replies_;
  if (replies_ == config_.garbage_at) {
    waiting_.insert(waiting_.end(), 30, 0x55);
    return;
  }
  if (config_.newer && replies_ % config_.heartbeat_every == 0) {
    waiting_.insert(waiting_.end(), kInverse3Heartbeat.begin(),
                    kInverse3Heartbeat.end());
    waiting_.insert(waiting_.end(), {0x12, 0x34});
  }
  waiting_.insert(waiting_.end(), state.begin(), state.end());
}

int Inverse3Model::receive(std::span<std::uint8_t> packet, std::int64_t now_ns) {
  if (waiting_.empty() || now_ns < ready_ns_) {
    return -EAGAIN;
  }
  std::size_t count = 0;
  while (count < std::min(packet.size(), config_.split_bytes) && !waiting_.empty()) {
    packet[count++] = waiting_.front();
    waiting_.pop_front();
  }
  return static_cast<int>(count);
}

std::int64_t Inverse3Model::next_ns(std::int64_t now_ns) {
  return waiting_.empty() ? now_ns + kMillisecond : ready_ns_;
}

std::unique_ptr<Inverse3Link> EmulatedInverse3::link(
    const std::shared_ptr<EmulatedInverse3>& device, const Inverse3Config& config) {
  return std::make_unique<Inverse3Link>(
      config,
      [device] {
        device->usb_ = std::make_unique<EmulatedUsb>(device->bus_);
        return device->usb_->descriptor();
      },
      [device](int /*descriptor*/) {
        device->kernel_driver_ = device->usb_->kernel_driver();
        device->usb_.reset();
      });
}

}  // namespace palpate
