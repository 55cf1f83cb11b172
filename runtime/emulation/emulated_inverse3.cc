#include "runtime/emulation/emulated_inverse3.h"

#include <algorithm>

#include "runtime/usb/haply_axes.h"

namespace palpate {

Inverse3Model::Inverse3Model(const Inverse3ModelConfig& config)
    : SerialBoard(config.dynamics, config.hand, config.start_m, config.split_bytes,
                  config.trace_max),
      config_(config) {}

int Inverse3Model::send(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  port.clock.set(now_ns);
  port.ready_ns = now_ns + config_.answer_ns;
  port.heard.insert(port.heard.end(), bytes.begin(), bytes.end());
  while (!port.heard.empty()) {
    // A force command, the byte that wakes up, or one byte that is passed over.
    const bool force = port.heard[0] == kInverse3Force;
    const std::size_t length = force ? kInverse3ForceBytes : 1;
    if (port.heard.size() < length) {
      break;
    }
    if (force) {
      obey(now_ns);
    } else if (port.heard[0] == kInverse3Wake) {
      wake();
    }
    port.heard.erase(port.heard.begin(),
                     port.heard.begin() + static_cast<std::ptrdiff_t>(length));
  }
  return static_cast<int>(bytes.size());
}

void Inverse3Model::wake() {
  if (wakes_++ >= config_.deaf) {
    port.waiting.push_back(kInverse3Wake);
    port.waiting.insert(port.waiting.end(), config_.newer ? 16 : kInverse3WakeBytes - 1,
                        7);
  }
}

void Inverse3Model::obey(std::int64_t now_ns) {
  if (wakes_ <= config_.deaf) {
    return;
  }
  std::array<std::uint8_t, kInverse3ForceBytes> command{};
  std::copy_n(port.heard.begin(), command.size(), command.begin());
  const DeviceReading at = look();
  const Inverse3State state = encode_inverse3_state(
      to_haply(at.position_m), to_haply(tool().motion().velocity_m_per_s));
  push(from_haply(decode_inverse3_force(command)), now_ns);
  ++replies_;
  if (config_.garbage_at >= 0 && replies_ >= config_.garbage_at &&
      replies_ < config_.garbage_at + config_.garbage_count) {
    port.waiting.insert(port.waiting.end(), 30, 0x55);
    return;
  }
  if (config_.newer && replies_ % config_.heartbeat_every == 0) {
    port.waiting.insert(port.waiting.end(), kInverse3Heartbeat.begin(),
                        kInverse3Heartbeat.end());
    port.waiting.insert(port.waiting.end(), {0x12, 0x34});
  }
  port.waiting.insert(port.waiting.end(), state.begin(), state.end());
}

}  // namespace palpate
