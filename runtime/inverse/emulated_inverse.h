// Haply's Inverse service without Haply: a WebSocket server with the mechanism's
// dynamics and the hand that holds it, in a thread of its own. The server answers every
// message with one state and says on its events port what happens to its device. The
// server can do everything wrong that a driver must survive.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "runtime/emulation/emulated_falcon_board.h"
#include "runtime/hand/hand_script.h"
#include "runtime/hand/simulated_device.h"
#include "runtime/hand/turn_script.h"

namespace palpate {

enum class InverseFault : std::uint8_t {
  kNone,
  kLate,      ///< answers come late_ns late
  kMissing,   ///< answers do not come
  kNotReady,  ///< status.ready is false
  kNotCalibrated,
  kNoPower,
  kNoPosition,    ///< a state without one
  kText,          ///< answers are `text`
  kUnasked,       ///< a hundred states for one message
  kUnplugged,     ///< the device is listed no more; an event says so
  kSilentUnplug,  ///< the same without an event
  kEvent,         ///< `text` on the events port
  kClosed,        ///< the session is closed as the protocol has it
  kCutFrame,      ///< half a frame, then the connection ends
  kNoGrip,        ///< the grip is listed no more
  kNoTurn,        ///< its orientation is four zeros
};

struct InverseFaults {
  InverseFault fault = InverseFault::kNone;
  std::int64_t from = 1;    ///< number of the message, from 1, over all sessions
  std::int64_t count = -1;  ///< messages that it concerns; -1: all from there on
  std::int64_t every = 1;   ///< > 0: of them each n-th
  std::int64_t late_ns = 0;
  std::string text{};
};

struct EmulatedInverseConfig {
  SimulatedDeviceConfig dynamics{};
  HandScript hand{};                         ///< in InverseLink's frame
  Eigen::Vector3d start_m{0.0, 0.15, 0.12};  ///< [m] as inverse_rest_m()
  std::uint16_t port = 0;                    ///< 0: any free one
  std::uint16_t events_port = 0;
  std::string version = "3.5.1";  ///< decides the force's key: "vector" from 3.5 on
  std::string device_id = "049D";
  int devices = 1;  ///< listed; the others stand still
  int grips = 1;    ///< listed, all turned alike
  /// How the hand turns the grip from its first message on, in InverseLink's frame; the
  /// grip's own zero is another one.
  TurnScript grip{.normal = Eigen::Vector3d::UnitY(), .tilt_rad = 0.0, .turn_rad = 0.0};
  /// Instead of the script, by time [s]; empty: the script.
  std::function<Eigen::Quaterniond(double)> grip_turn{};
  bool in_use = false;
  double force_gate = 0.3;          ///< [-] shown only
  bool gravity_compensated = true;  ///< shown only
  /// [ns] > 0 after the last command until the force ends. The real one's is not
  /// documented.
  std::int64_t idle_ns = 50'000'000;
  std::size_t trace_max = 0;  ///< commands that trace() keeps
  InverseFaults faults{};
};

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
