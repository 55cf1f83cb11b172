// The protocol of Haply's Inverse service without its sockets: what a session says and
// hears, by whoever carries its messages. inverse_link.h carries them over sockets of
// this machine, a page over those of its browser.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "runtime/device/device.h"
#include "runtime/inverse/inverse_message.h"

namespace palpate {

/// [m] middle of the workspace, about: y up, z towards the person.
[[nodiscard]] inline Eigen::Vector3d inverse_rest_m() {
  return {0.0, 0.15, 0.12};
}

struct InverseConfig {
  std::uint16_t port = kInversePort;  ///< of states and forces, and of HTTP
  std::uint16_t events_port = kInverseEventsPort;  ///< of what happens to devices
  std::string device_id{};                         ///< empty: the only one
  std::string grip_id{};                   ///< the same, of those that measure turns
  std::string profile = "palpate:device";  ///< of the session; is_profile_name()
  double answer_s = 0.02;                  ///< [s] > 0 for one state
  double open_s = 5.0;                     ///< [s] > 0 for each step of open()
  double force_max_n = 5.0;                ///< [N] > 0
  double damping_n_s_per_m = 0.5;          ///< [N s/m] assumed, not measured
  double coulomb_n = 0.03;                 ///< [N] assumed, not measured
  double resolution_m = 5e-5;              ///< [m] assumed, not measured
  std::string what = "haply-inverse";
  std::function<void(const std::string&)> tell{};  ///< what alters what is felt
  std::shared_ptr<const void> kept{};              ///< lives as long as the link
};

/// Of the device behind the service. The service's own exchange with the device is
/// assumed to take 1 ms.
[[nodiscard]] DeviceLimits inverse_limits(const InverseConfig& config);

/// One session; one thread. First greet(), then one command for every state. Functions
/// that return a text return why the session must end, or null. The force is zero in
/// the first two commands, and after a state that did not come in time until one has. A
/// grip that is there when the session begins says how the tool is turned. A grip that
/// is not heard of for kGripSilentMax states is a fault. A grip that says what is no
/// orientation is a fault, too.
class InverseSession {
 public:
  /// @throws InputError for a profile or id that cannot be a name.
  explicit InverseSession(InverseConfig config);

  /// The service's first message, of devices and grips. @param key of forces
  /// (force_key()). @throws DeviceError for a device that is not there, in use, or not
  /// to be pushed.
  void greet(std::string_view text, const char* key);

  /// Another spelling of forces from the next command on.
  void speak(const char* key) noexcept { key_ = key; }

  /// The next command, valid until the one after it; no allocation. @param force_n [N]
  /// of which sent_n() is in the command. @param profile the session's, in its first
  /// command; empty afterwards.
  [[nodiscard]] std::string_view command(const Eigen::Vector3d& force_n,
                                         std::string_view profile = {}) noexcept;

  /// A state that came; one that came while no command was on its way.
  [[nodiscard]] const char* take(std::string_view text) noexcept;
  [[nodiscard]] const char* take_unasked() noexcept;
  /// The exchange is over: a state answered in time, or none did.
  [[nodiscard]] const char* exchanged(bool in_time) noexcept;
  /// Whether commands before the latest are without an answer. States that answer them
  /// may come first: until none comes for kQuietS, the last one counts.
  [[nodiscard]] bool missing() const noexcept { return missed_ > 0; }

  /// What happens to devices.
  [[nodiscard]] const char* take_event(std::string_view text) const noexcept;

  [[nodiscard]] const InverseConfig& config() const noexcept { return config_; }
  [[nodiscard]] const Eigen::Vector3d& position_m() const noexcept {
    return position_m_;
  }
  [[nodiscard]] const Eigen::Vector3d& sent_n() const noexcept { return sent_n_; }
  [[nodiscard]] bool measures_turns() const noexcept { return turned_; }
  [[nodiscard]] const Eigen::Quaterniond& turn() const noexcept { return turn_; }

  static constexpr int kGripSilentMax = 100;
  static constexpr double kQuietS = 0.005;  ///< [s]

 private:
  void choose_grip(const InverseState& state);
  void tell_filters(const InverseDevice& device) const;
  [[nodiscard]] InverseState first_state(std::string_view text) const;
  [[nodiscard]] const char* take_state(std::string_view text) noexcept;
  [[nodiscard]] const char* take_turn(const InverseGrip& grip) noexcept;

  InverseConfig config_;
  ShortText id_;
  ShortText grip_;       // while turned_
  bool turned_ = false;  // by that grip
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  int grip_silent_ = 0;  // states in a row without it
  const char* key_ = "";
  std::array<char, kInverseCommandBytes> command_{};
  Eigen::Vector3d position_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d sent_n_ = Eigen::Vector3d::Zero();
  bool begun_ = false;  // the first command was answered
  bool known_ = false;  // the latest command was answered
  int missed_ = 0;      // exchanges without an answer, in a row
  int owed_ = 0;        // states for commands that were sent
  int unasked_ = 0;     // states beyond those, of this session
};

}  // namespace palpate
