#include "runtime/usb/inverse3_packet.h"

#include <algorithm>
#include <bit>

namespace palpate {
namespace {

constexpr double kPositionMaxM = 1.0;
constexpr double kSpeedMaxMPerS = 20.0;

void put(std::uint8_t* at, double value) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  for (unsigned i = 0; i < 4; ++i) {
    at[i] = static_cast<std::uint8_t>(bits >> (8 * i));
  }
}

double real(const std::uint8_t* at) noexcept {
  std::uint32_t bits = 0;
  for (unsigned i = 0; i < 4; ++i) {
    bits |= static_cast<std::uint32_t>(at[i]) << (8 * i);
  }
  return static_cast<double>(std::bit_cast<float>(bits));
}

void put(std::uint8_t* at, const Eigen::Vector3d& v) noexcept {
  for (int i = 0; i < 3; ++i) {
    put(at + static_cast<std::ptrdiff_t>(4) * i, v[i]);
  }
}

Eigen::Vector3d vector_at(const std::uint8_t* at) noexcept {
  return {real(at), real(at + 4), real(at + 8)};
}

}  // namespace

std::array<std::uint8_t, kInverse3ForceBytes> encode_inverse3_force(
    const Eigen::Vector3d& force_n) noexcept {
  std::array<std::uint8_t, kInverse3ForceBytes> bytes{kInverse3Force};
  put(bytes.data() + 1, force_n.allFinite() ? force_n : Eigen::Vector3d::Zero());
  return bytes;
}

Eigen::Vector3d decode_inverse3_force(
    std::span<const std::uint8_t, kInverse3ForceBytes> bytes) noexcept {
  return vector_at(bytes.data() + 1);
}

Inverse3State encode_inverse3_state(const Eigen::Vector3d& position_m,
                                    const Eigen::Vector3d& velocity_m_per_s) noexcept {
  Inverse3State bytes{kInverse3State};
  put(bytes.data() + 1, position_m);
  put(bytes.data() + 13, velocity_m_per_s);
  return bytes;
}

std::optional<Eigen::Vector3d> decode_inverse3_position(
    std::span<const std::uint8_t, kInverse3StateBytes> bytes) noexcept {
  const Eigen::Vector3d position_m = vector_at(bytes.data() + 1);
  const Eigen::Vector3d velocity_m_per_s = vector_at(bytes.data() + 13);
  const bool can_be = bytes[0] == kInverse3State && position_m.allFinite() &&
                      velocity_m_per_s.allFinite() &&
                      position_m.cwiseAbs().maxCoeff() <= kPositionMaxM &&
                      velocity_m_per_s.norm() <= kSpeedMaxMPerS;
  return can_be ? std::optional(position_m) : std::nullopt;
}

Inverse3Framer::Found Inverse3Framer::take(std::uint8_t byte) noexcept {
  bytes_[size_++] = byte;
  const bool heartbeat = bytes_[0] == kInverse3Heartbeat[0];
  if (!heartbeat && bytes_[0] != kInverse3State) {
    return Found::kNonsense;
  }
  if (heartbeat) {
    const std::size_t known = std::min(size_, kInverse3Heartbeat.size());
    if (!std::equal(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(known),
                    kInverse3Heartbeat.begin())) {
      return Found::kNonsense;
    }
  }
  if (size_ < (heartbeat ? kInverse3HeartbeatBytes : kInverse3StateBytes)) {
    return Found::kNothing;
  }
  size_ = 0;
  return heartbeat ? Found::kNothing : Found::kState;
}

}  // namespace palpate
