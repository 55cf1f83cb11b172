#include "runtime/emulation/emulated_inverse3.h"

#include <algorithm>

#include "runtime/usb/haply_axes.h"

namespace palpate {

Inverse3Model::Inverse3Model(const Inverse3ModelConfig& config)
    : SerialBoard(config.dynamics, config.hand, config.start_m, config.split_bytes,
                  config.trace_max),
      config_(config) {}

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
  std::array<std::uint8_t, kInverse3ForceBytes> command{};
  std::copy_n(heard_.begin(), command.size(), command.begin());
  const DeviceReading at = look();
  const Inverse3State state = encode_inverse3_state(
      to_haply(at.position_m), to_haply(tool_.motion().velocity_m_per_s));
  push(from_haply(decode_inverse3_force(command)), now_ns);
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

}  // namespace palpate
