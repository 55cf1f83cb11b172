// The runtime behind a live view of a tool with one contact: slow and fast process,
// FIFO, ledger and safety as in any run, on simulated time, with a pointer in place of
// a hand.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "formats/database/response_database.h"
#include "formats/recording/recording.h"
#include "runtime/hand/pointer_hand.h"
#include "runtime/hand/simulated_device.h"
#include "runtime/realtime/deadlines.h"
#include "runtime/render/fast_process.h"
#include "runtime/render/one_contact.h"
#include "runtime/slow/memory_elements.h"
#include "runtime/view/adjusted_elements.h"
#include "runtime/view/live_session.h"
#include "runtime/view/view_contact.h"
#include "runtime/view/view_dents.h"

namespace palpate {

struct ViewSessionOptions {
  std::string tool = {};  ///< empty: the only one
  LocalModel model = LocalModel::kPotential;
  double fast_hz = 2000.0;   ///< [Hz] [100, 20000]
  double slow_hz = 100.0;    ///< [Hz] [1, fast_hz]
  double force_max_n = 8.0;  ///< [N] > 0
  SimulatedDeviceConfig device = {};
  std::vector<YieldedRow> surface = {};  ///< what had yielded before
  /// Elements of a body whose responses are not in the database; outlives the session.
  ElementSender* growing = nullptr;
};

/// @throws InputError for a rate outside [100, 20000] or [1, fast_hz] Hz, or a force
/// that is not positive.
void check_rates(double fast_hz, double slow_hz, double force_max_n);

class ViewSession : public LiveSession {
 public:
  /// `database` must outlive the session. @throws InputError for options out of range.
  ViewSession(const ResponseDatabase& database, const ViewSessionOptions& options);

  /// The hand takes the tool to where the pointer is [m].
  void hold(const Eigen::Vector3d& pointer_m);

  /// The hand lifts the tool off the body, along the normal of the nearest point.
  void let_go() override;

  void heed(const HandWish& wish) override;
  void set(const ViewRequest& request) override;
  void use(LocalModel model);
  void set_slow_hz(double slow_hz);  ///< [Hz] above zero; the fast rate at most is used
  void set_stiffness_scale(double scale);             ///< [-] > 0
  void set_friction(std::optional<double> friction);  ///< none: the database's

  void advance(std::int64_t ticks) override;

  /// A new run: clear of the body, faults and accounts gone, settings kept. The body is
  /// as it was at the start of the session: new dents are gone.
  void reset() override;

  [[nodiscard]] bool holding() const override { return holding_; }
  [[nodiscard]] bool touching() const override;
  [[nodiscard]] Fault fault() const override { return report().fault; }
  [[nodiscard]] std::int64_t ticks() const override { return report().ticks; }
  [[nodiscard]] double fast_hz() const override { return options_.fast_hz; }
  [[nodiscard]] double slow_hz() const override { return options_.slow_hz; }
  [[nodiscard]] ViewFrame frame() override;
  [[nodiscard]] const ViewSessionOptions& options() const noexcept { return options_; }
  [[nodiscard]] const RenderReport& report() const noexcept { return fast_->report(); }
  [[nodiscard]] const TickRecord& latest() const noexcept { return latest_; }
  [[nodiscard]] const PointerHand& hand() const noexcept { return hand_; }
  [[nodiscard]] double stiffness_scale() const { return adjusted_.stiffness_scale(); }
  [[nodiscard]] std::optional<double> friction() const { return adjusted_.friction(); }
  [[nodiscard]] const ResponseTable& table() const override { return table_; }
  [[nodiscard]] const ResponseDatabase& database() const override { return database_; }
  [[nodiscard]] std::int64_t slow_updates() const noexcept { return slow_updates_; }

  /// Net work that was put into the local model since the start [J], by its ledger;
  /// negative: it has created energy, as only the holds can.
  [[nodiscard]] double net_work_j() const { return report().model_work_j; }

  [[nodiscard]] ViewContact contact() const;

  /// What has yielded until now.
  [[nodiscard]] std::vector<YieldedRow> yielded() const { return body_->yielded(); }

  /// What of earlier presses has not recovered, or never will.
  [[nodiscard]] std::vector<NodeDent> dents() const {
    return dents_.at(body_->dents(), stiffness_scale());
  }

  [[nodiscard]] std::vector<TickRecord> take_ticks() override;

 private:
  void start(const Eigen::Vector3d& at_m);
  void tick();
  [[nodiscard]] Eigen::Vector3d clear_of(const Eigen::Vector3d& from_m) const;

  const ResponseDatabase& database_;
  const ResponseTable& table_;
  ViewSessionOptions options_;
  ElementStream stream_;
  AdjustedStream adjusted_;
  ViewDents dents_;
  Eigen::Vector3d start_m_;
  PointerHand hand_;
  SimulatedClock clock_;
  std::unique_ptr<SimulatedDevice> device_;
  std::unique_ptr<Telemetry> telemetry_;
  std::unique_ptr<OneContact> body_;
  std::unique_ptr<FastProcess> fast_;
  Deadlines fast_deadlines_;
  Deadlines slow_deadlines_;
  TickRecord latest_;
  std::vector<TickRecord> ticks_;
  std::int64_t slow_updates_ = 0;
  bool holding_ = false;
};

}  // namespace palpate
