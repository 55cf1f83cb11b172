// The runtime behind a live view of a tool with several contacts, or of two hands on
// one body: slow and fast process and ledger (coupled_step.h) on simulated time,
// with a pointer in place of each hand.
//
// Forces move the tools; turns are the pointers', which the hands' wrists follow
// whatever the torque is. What is set while tools press changes the body for all
// contacts at one tick: the ledger books it, and what stored energy and tank do not pay
// is taken by delta_0 until the contacts have been lifted.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "formats/database/response_database.h"
#include "formats/mesh/surface_search.h"
#include "runtime/contacts/coupled_step.h"
#include "runtime/hand/pointer_hand.h"
#include "runtime/hand/simulated_device.h"
#include "runtime/realtime/clock.h"
#include "runtime/realtime/deadlines.h"
#include "runtime/slow/coupled_storage.h"
#include "runtime/view/adjusted_contacts.h"
#include "runtime/view/live_session.h"
#include "runtime/view/view_dents.h"
#include "runtime/view/view_hands.h"

namespace palpate {

struct ContactSessionOptions {
  std::vector<std::string> tools = {};  ///< 1, or 2 for two hands; none: the only one
  double fast_hz = 2000.0;              ///< [Hz] [100, 20000]
  double slow_hz = 100.0;               ///< [Hz] [1, fast_hz]
  double force_max_n = 8.0;             ///< [N] > 0
  SimulatedDeviceConfig device = {};
};

class ContactSession : public LiveSession {
 public:
  static constexpr double kTurnRadPerS = 3.0;      ///< [rad/s] a wrist at most
  static constexpr double kTurnFollowPerS = 25.0;  ///< [1/s] as it comes near

  /// `database` must outlive the session. @throws InputError for options out of range,
  /// and as coupled_set().
  ContactSession(const ResponseDatabase& database,
                 const ContactSessionOptions& options);

  void heed(const HandWish& wish) override;
  void let_go() override;
  void set(const ViewRequest& request) override;
  void advance(std::int64_t ticks) override;
  void reset() override;

  [[nodiscard]] bool holding() const override;
  [[nodiscard]] bool touching() const override { return command_.in_contact; }
  [[nodiscard]] Fault fault() const override {
    return static_cast<Fault>(command_.fault);
  }
  [[nodiscard]] std::int64_t ticks() const override { return run_.ticks; }
  [[nodiscard]] double fast_hz() const override { return options_.fast_hz; }
  [[nodiscard]] double slow_hz() const override { return options_.slow_hz; }
  [[nodiscard]] const ResponseDatabase& database() const override { return database_; }
  [[nodiscard]] const ResponseTable& table() const override { return *tables_.front(); }
  [[nodiscard]] ViewFrame frame() override;
  [[nodiscard]] std::vector<TickRecord> take_ticks() override;

  [[nodiscard]] const std::vector<const ResponseTable*>& tables() const noexcept {
    return tables_;
  }
  [[nodiscard]] const CoupledState& state() const noexcept { return storage_->state(); }
  [[nodiscard]] const WrenchCommand& command() const noexcept { return command_; }
  [[nodiscard]] const PassivityLedger& account() const noexcept {
    return account_of(storage_->state());
  }

  /// Wrenches of the body on the tools at the present poses, without friction and
  /// delta_0, with contacts that couple or do not; none where that has no solution or
  /// nothing has been sampled.
  [[nodiscard]] std::optional<PortWrenches> elastic(bool coupled);

 private:
  // A tool in the hand that follows its pointer.
  struct Held {
    const ResponseTable* table = nullptr;
    Eigen::Vector3d start_m = Eigen::Vector3d::Zero();
    PointerHand pointer{Eigen::Vector3d::Zero()};
    std::unique_ptr<SimulatedDevice> device;
    Eigen::Quaterniond upright = Eigen::Quaterniond::Identity();  // at start_m
    Eigen::Quaterniond goal = Eigen::Quaterniond::Identity();
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    bool holding = false;
  };

  void add_dents(const ResponseTable& tool);
  void place(Held& hand, const ResponseTable& table, std::int32_t node);
  void start();
  void tick();
  void serve();
  void account_tick();
  void lift(Held& hand);
  void clear_fifo();
  [[nodiscard]] PortPoses sampled();
  [[nodiscard]] Eigen::Vector3d clear_of(const Held& hand,
                                         const Eigen::Vector3d& from_m) const;
  [[nodiscard]] std::vector<ViewTouch> touches() const;
  [[nodiscard]] ViewHands hands();
  [[nodiscard]] std::vector<NodeDent> dents() const;

  const ResponseDatabase& database_;
  std::vector<const ResponseTable*> tables_;
  std::vector<ViewDents> dents_;  // of each radius of each tool
  ContactSessionOptions options_;
  AdjustedContacts adjusted_;
  SurfaceSearch search_;
  std::vector<Held> hands_;
  SimulatedClock clock_;
  std::optional<CoupledStorage> storage_;
  std::unique_ptr<ContactFifo> fifo_ = std::make_unique<ContactFifo>();
  std::unique_ptr<CoupledField> scratch_ = std::make_unique<CoupledField>();
  Deadlines fast_deadlines_;
  Deadlines slow_deadlines_;
  WrenchCommand command_;
  PortPoses pose_;
  ViewRun run_;
  TickRecord latest_;
  std::vector<TickRecord> ticks_;
  std::vector<ViewLoads> loads_;
};

}  // namespace palpate
