// What the Haply Inverse service says and hears, as JSON: of every message the few
// fields that matter, in fixed memory. Whoever holds the port may say anything: what is
// not right is refused in whole.
//
// Source: docs.haply.co/inverseSDK, version 3.5: service/realtime/websocket-protocol,
// service/realtime/control-commands, service/events.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate {

constexpr std::uint16_t kInversePort = 10001;        ///< of states, forces and HTTP
constexpr std::uint16_t kInverseEventsPort = 10020;  ///< of what happens to devices
constexpr std::size_t kInverseMessageBytes = 65536;  ///< longest that is taken
constexpr double kInversePositionMaxM = 2.0;         ///< [m] of a coordinate

/// A name out of a message: short, printable, or not taken.
class ShortText {
 public:
  static constexpr std::size_t kBytes = 48;

  /// False, and empty, for what is longer or has other than printable ASCII.
  bool assign(std::string_view text) noexcept;
  [[nodiscard]] std::string_view view() const noexcept {
    return {bytes_.data(), size_};
  }

 private:
  std::array<char, kBytes> bytes_{};
  std::size_t size_ = 0;
};

/// One device of a state message; what a message may leave out is optional.
struct InverseDevice {
  ShortText id;
  std::optional<Eigen::Vector3d> position_m;  ///< [m] of the cursor, device's base
  std::optional<bool> ready;
  std::optional<bool> calibrated;
  std::optional<bool> in_use;        ///< by any session
  std::optional<bool> power_supply;  ///< motors have one
  // What the service changes of the force that is asked for, from its first message.
  std::optional<bool> gravity_compensated;
  std::optional<double> force_gate;  ///< [-] gain of a filter, 0: off
  std::optional<double> damping;     ///< [-] of a filter, 0: off
};

/// A handle that measures how it is turned (VerseGrip), by wire or without.
struct InverseGrip {
  ShortText id;
  std::optional<Eigen::Quaterniond> orientation;  ///< as it was said: any four numbers
};

struct InverseState {
  int devices = 0;         ///< in the message
  bool found = false;      ///< the one that was asked for
  InverseDevice device{};  ///< that one
  int grips = 0;           ///< in the message
  InverseGrip grip{};  ///< the one that was asked for; without orientation: not there
};

/// @param id whose state is wanted; empty: the first. @param grip_id likewise. @returns
/// null, or why the message was refused; `state` then says nothing. Any bytes, no
/// allocation.
[[nodiscard]] const char* scan_inverse_state(std::string_view text, std::string_view id,
                                             InverseState& state,
                                             std::string_view grip_id = {}) noexcept;

struct InverseEvent {
  ShortText name;
  ShortText level;
  ShortText device_id;
  ShortText safety_type;
};

/// As scan_inverse_state().
[[nodiscard]] const char* scan_inverse_event(std::string_view text,
                                             InverseEvent& event) noexcept;

/// Why a device must not be rendered on after an event; null if it may.
[[nodiscard]] const char* fault_of(const InverseEvent& event,
                                   std::string_view id) noexcept;

struct InverseVersion {
  int major = 0;
  int minor = 0;
};

/// The first "3.5" or "3.5.1" in what the service says of its version.
[[nodiscard]] std::optional<InverseVersion> inverse_version(
    std::string_view text) noexcept;

/// A force's components are "vector" from 3.5 on, "values" before; null for versions
/// whose messages are others (before 3.1).
[[nodiscard]] const char* force_key(const InverseVersion& version) noexcept;

/// May be the name of a session's profile: 1 to 64 letters, digits and ._:-
[[nodiscard]] bool is_profile_name(std::string_view name) noexcept;

/// A force [N] on a device's cursor, as JSON. @param profile of the session, in its
/// first message; empty afterwards. @param into at least kInverseCommandBytes.
/// @returns bytes written. No allocation.
constexpr std::size_t kInverseCommandBytes = 512;
[[nodiscard]] std::size_t write_inverse_command(std::span<char> into,
                                                std::string_view id, const char* key,
                                                const Eigen::Vector3d& force_n,
                                                std::string_view profile) noexcept;

}  // namespace palpate
