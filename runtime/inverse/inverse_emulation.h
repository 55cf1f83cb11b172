// What Haply's Inverse service says and does, without its sockets: the mechanism's
// dynamics and the hand that holds it, by messages. The service can do everything wrong
// that a driver must survive.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "runtime/emulation/emulated_falcon_board.h"
#include "runtime/hand/hand_script.h"
#include "runtime/hand/simulated_device.h"
#include "runtime/hand/turn_script.h"
#include "runtime/realtime/clock.h"

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

/// One thread. What it has to say of devices goes to `tell` [JSON].
class InverseEmulation {
 public:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  /// @param clock outlives it.
  InverseEmulation(const EmulatedInverseConfig& config, Clock& clock,
                   std::function<void(const std::string& event)> tell);

  [[nodiscard]] std::string version() const;
  /// What a connection begins with, and what answers a message that was obeyed.
  [[nodiscard]] std::string first_message();
  [[nodiscard]] std::string answer();
  /// A command of another spelling is no command; the force ends where none comes.
  void obey(const std::string& text);
  void release() { push(Eigen::Vector3d::Zero()); }

  [[nodiscard]] bool is_faulty(InverseFault fault) const {
    const InverseFaults& f = config_.faults;
    return f.fault == fault && message_ >= f.from &&
           (f.count < 0 || message_ < f.from + f.count) &&
           (message_ - f.from) % f.every == 0;
  }
  /// [ns] when the force ends, if no command comes.
  [[nodiscard]] std::int64_t idle_due_ns() const { return idle_due_ns_; }

  [[nodiscard]] const SimulatedDevice& tool() const { return tool_; }
  [[nodiscard]] std::int64_t messages() const { return message_; }
  [[nodiscard]] const std::string& profile() const { return profile_; }
  [[nodiscard]] const std::string& refused() const { return refused_; }
  [[nodiscard]] std::int64_t released_ns() const { return released_ns_; }
  [[nodiscard]] const std::vector<MotorRecord>& trace() const { return trace_; }
  /// [J] of the forces on the tool so far, less what its own damping took.
  [[nodiscard]] double given_to_hand_j() const;

 private:
  [[nodiscard]] nlohmann::json state(bool whole);
  [[nodiscard]] nlohmann::json grips();
  void push(const Eigen::Vector3d& force_n);

  EmulatedInverseConfig config_;
  Clock& clock_;
  std::function<void(const std::string&)> tell_;
  SimulatedDevice tool_;
  std::int64_t message_ = 0;
  std::int64_t first_ns_ = 0;  // of messages
  std::int64_t released_ns_ = 0;
  std::string profile_;
  std::string refused_;
  std::vector<MotorRecord> trace_;
  const char* key_ = nullptr;
  bool reported_ = false;
  std::int64_t idle_due_ns_ = kNever;
};

}  // namespace palpate
