// Haply's Inverse service without Haply: a WebSocket server with the mechanism's
// dynamics and the hand that holds it, in a thread of its own. The server answers every
// message with one state and says on its events port what happens to its device
// (inverse_emulation.h).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "runtime/inverse/inverse_emulation.h"

namespace palpate {

class EmulatedInverse {
 public:
  /// Listens on 127.0.0.1. @throws DeviceError if a port cannot be had.
  explicit EmulatedInverse(const EmulatedInverseConfig& config);
  ~EmulatedInverse();
  EmulatedInverse(const EmulatedInverse&) = delete;
  EmulatedInverse& operator=(const EmulatedInverse&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] std::uint16_t events_port() const;

  /// Force on the tool now [N]; messages so far; the latest profile that a session
  /// named; the latest thing that was not understood.
  [[nodiscard]] Eigen::Vector3d force_n() const;
  [[nodiscard]] std::int64_t messages() const;
  [[nodiscard]] std::string profile() const;
  [[nodiscard]] std::string refused() const;

  /// [J] of the forces on the tool so far, less what its own damping took.
  [[nodiscard]] double given_to_hand_j() const;

  /// [ns] monotonic, when the force last became zero after it was not; 0: never.
  [[nodiscard]] std::int64_t released_ns() const;

  /// The motors' account at every command.
  [[nodiscard]] std::vector<MotorRecord> trace() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpate
