// Haply's Inverse3, Inverse3x and Minverse through Haply's Inverse service. The service
// runs on this machine, owns the device and speaks JSON over a WebSocket. The service
// sends one state for every command (inverse_message.h).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "runtime/device/device_link.h"
#include "runtime/inverse/inverse_message.h"
#include "runtime/inverse/inverse_socket.h"

namespace palpate {

/// [m] middle of the workspace, about: y up, z towards the person.
[[nodiscard]] inline Eigen::Vector3d inverse_rest_m() {
  return {0.0, 0.15, 0.12};
}

struct InverseConfig {
  std::uint16_t port = 10001;              ///< of states and forces, and of HTTP
  std::uint16_t events_port = 10020;       ///< of what happens to devices
  std::string device_id{};                 ///< empty: the only one
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

/// Watches the service's events beside its states. Whatever ends the exchange, the name
/// for it is failure(). Causes are: unplugged, busy, not ready, emergency brake, stall,
/// a message that was refused, a service that stopped. The next message is then zero
/// force, the last one; and the session is ended, with what it asked for. After a state
/// that did not come in time the force is zero until one does. That state answers the
/// latest command: late ones before it are passed over. A grip that is there when the
/// link is opened says how the tool is turned. A grip that is not heard of for
/// kGripSilentMax states is a fault. A grip that says what is no orientation is a
/// fault, too.
class InverseLink : public DeviceLink {
 public:
  /// @throws InputError for a profile or id that cannot be a name.
  explicit InverseLink(InverseConfig config);
  ~InverseLink() override;

  [[nodiscard]] std::string name() const override { return config_.what; }
  [[nodiscard]] DeviceLimits limits() const override;
  void open() override;
  [[nodiscard]] LinkStatus transact(const Eigen::Vector3d& force_n,
                                    Eigen::Vector3d& position_m) noexcept override;
  [[nodiscard]] Eigen::Vector3d sent_n() const noexcept override { return sent_n_; }
  [[nodiscard]] bool measures_turns() const noexcept override { return turned_; }
  [[nodiscard]] Eigen::Quaterniond turn() const noexcept override { return turn_; }
  void close() noexcept override;
  [[nodiscard]] std::string failure() const override { return failure_; }

  static constexpr int kGripSilentMax = 100;

 private:
  void greet();
  void choose_grip(const InverseState& state);
  void tell_filters(const InverseDevice& device) const;
  [[nodiscard]] InverseState first_state();
  [[nodiscard]] LinkStatus give_up(const char* why) noexcept;
  [[nodiscard]] bool send(const Eigen::Vector3d& force_n,
                          std::string_view profile) noexcept;
  [[nodiscard]] LinkStatus exchange(const Eigen::Vector3d& force_n,
                                    std::string_view profile) noexcept;
  [[nodiscard]] const char* take_state(std::string_view text) noexcept;
  [[nodiscard]] const char* take_turn(const InverseGrip& grip) noexcept;
  [[nodiscard]] const char* take_answer(std::string_view text) noexcept;
  [[nodiscard]] const char* take_waiting() noexcept;
  [[nodiscard]] const char* heard_fault() noexcept;

  InverseConfig config_;
  std::unique_ptr<InverseSocket> states_;
  std::unique_ptr<InverseSocket> events_;
  ShortText id_;
  ShortText grip_;       // while turned_
  bool turned_ = false;  // by that grip
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  int grip_silent_ = 0;  // states in a row without it
  const char* key_ = "";
  std::array<char, kInverseCommandBytes> command_{};
  Eigen::Vector3d position_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d sent_n_ = Eigen::Vector3d::Zero();
  bool known_ = false;  // the latest command was answered
  int missed_ = 0;      // exchanges without an answer, in a row
  int owed_ = 0;        // states for commands that were sent
  int unasked_ = 0;     // states beyond those, of this session
  const char* failure_ = "";
};

}  // namespace palpate
