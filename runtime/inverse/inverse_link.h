// Haply's Inverse3, Inverse3x and Minverse through Haply's Inverse service. The service
// runs on this machine, owns the device and speaks JSON over a WebSocket. The service
// sends one state for every command (inverse_message.h).
#pragma once

#include <memory>
#include <string>

#include "runtime/device/device_link.h"
#include "runtime/inverse/inverse_session.h"
#include "runtime/inverse/inverse_socket.h"

namespace palpate {

/// Watches the service's events beside its states. Whatever ends the exchange, the name
/// for it is failure(). Causes are: unplugged, busy, not ready, emergency brake, stall,
/// a message that was refused, a service that stopped. The next message is then zero
/// force, the last one; and the session is ended, with what it asked for. After a state
/// that did not come in time the force is zero until one does. That state answers the
/// latest command: late ones before it are passed over.
class InverseLink : public DeviceLink {
 public:
  /// @throws as InverseSession.
  explicit InverseLink(InverseConfig config);
  ~InverseLink() override;

  [[nodiscard]] std::string name() const override { return config().what; }
  [[nodiscard]] DeviceLimits limits() const override {
    return inverse_limits(config());
  }
  void open() override;
  [[nodiscard]] LinkStatus transact(const Eigen::Vector3d& force_n,
                                    Eigen::Vector3d& position_m) noexcept override;
  [[nodiscard]] Eigen::Vector3d sent_n() const noexcept override {
    return session_.sent_n();
  }
  [[nodiscard]] bool measures_turns() const noexcept override {
    return session_.measures_turns();
  }
  [[nodiscard]] Eigen::Quaterniond turn() const noexcept override {
    return session_.turn();
  }
  void close() noexcept override;
  [[nodiscard]] std::string failure() const override { return failure_; }

 private:
  [[nodiscard]] const InverseConfig& config() const { return session_.config(); }
  void greet();
  [[nodiscard]] LinkStatus give_up(const char* why) noexcept;
  [[nodiscard]] bool send(const Eigen::Vector3d& force_n,
                          std::string_view profile) noexcept;
  [[nodiscard]] LinkStatus exchange(const Eigen::Vector3d& force_n,
                                    std::string_view profile) noexcept;
  [[nodiscard]] const char* take_waiting() noexcept;
  [[nodiscard]] const char* heard_fault() noexcept;

  InverseSession session_;
  std::unique_ptr<InverseSocket> states_;
  std::unique_ptr<InverseSocket> events_;
  const char* failure_ = "";
};

}  // namespace palpate
