#include "runtime/usb/haply_packet.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace palpate {
namespace {

constexpr double kAngleMaxDeg = 3600.0;

void put_real(std::uint8_t* at, double value) noexcept {
  auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  for (int i = 0; i < 4; ++i) {
    at[i] = static_cast<std::uint8_t>(bits & 0xFF);
    bits >>= 8;
  }
}

double get_real(const std::uint8_t* at) noexcept {
  std::uint32_t bits = 0;
  for (int i = 3; i >= 0; --i) {
    bits = bits << 8 | at[i];
  }
  return static_cast<double>(std::bit_cast<float>(bits));
}

}  // namespace

std::array<std::uint8_t, kHaplySetupBytes> encode(const HaplySetup& setup) noexcept {
  constexpr std::uint8_t kBothPorts = 0b11;
  std::array<std::uint8_t, kHaplySetupBytes> bytes{1,
                                                   setup.id,
                                                   kBothPorts,
                                                   setup.motor_direction[0],
                                                   setup.motor_direction[1],
                                                   kBothPorts,
                                                   setup.encoder_direction[0],
                                                   setup.encoder_direction[1],
                                                   0,   // inputs
                                                   0};  // PWMs
  for (std::size_t i = 0; i < 2; ++i) {
    put_real(&bytes[10 + 8 * i], setup.offset_deg[i]);
    put_real(&bytes[14 + 8 * i], setup.counts_per_turn);
  }
  return bytes;
}

std::array<std::uint8_t, kHaplyTorqueBytes> encode_torques(
    std::uint8_t id, const std::array<double, 2>& torque_nm) noexcept {
  std::array<std::uint8_t, kHaplyTorqueBytes> bytes{2, id};
  for (std::size_t i = 0; i < 2; ++i) {
    const double torque = std::isfinite(torque_nm[i]) ? torque_nm[i] : 0.0;
    put_real(&bytes[2 + 4 * i],
             std::clamp(torque, -kHaplyTorqueMaxNm, kHaplyTorqueMaxNm));
  }
  return bytes;
}

std::array<std::uint8_t, kHaplyReplyBytes> encode_angles(
    std::uint8_t id, const std::array<double, 2>& angle_deg) noexcept {
  std::array<std::uint8_t, kHaplyReplyBytes> bytes{id};
  put_real(&bytes[1], angle_deg[0]);
  put_real(&bytes[5], angle_deg[1]);
  return bytes;
}

std::optional<std::array<double, 2>> decode_angles(
    std::uint8_t id, std::span<const std::uint8_t, kHaplyReplyBytes> bytes) noexcept {
  const std::array<double, 2> angle{get_real(&bytes[1]), get_real(&bytes[5])};
  const auto possible = [](double deg) {
    return std::abs(deg) <= kAngleMaxDeg;  // false for NaN
  };
  if (bytes[0] != id || !possible(angle[0]) || !possible(angle[1])) {
    return std::nullopt;
  }
  return angle;
}

std::array<double, 2> decode_torques(
    std::span<const std::uint8_t, kHaplyTorqueBytes> bytes) noexcept {
  return {get_real(&bytes[2]), get_real(&bytes[6])};
}

}  // namespace palpate
