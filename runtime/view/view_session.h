// The runtime behind a live view. The runtime has slow and fast process, FIFO, ledger
// and safety as in any run. The runtime is on simulated time, with a pointer in place
// of each hand.
//
// Forces move the tools; turns are the pointers', which the hands' wrists follow
// whatever the torque is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "formats/mesh/surface_search.h"
#include "formats/recording/kept_surface.h"
#include "formats/recording/tick_record.h"
#include "runtime/hand/hand_tape.h"
#include "runtime/hand/simulated_device.h"
#include "runtime/realtime/deadlines.h"
#include "runtime/render/fast_process.h"
#include "runtime/slow/element_source.h"
#include "runtime/view/steered_body.h"
#include "runtime/view/view_friction.h"
#include "runtime/view/view_json.h"

namespace palpate {

struct ViewSessionOptions {
  std::vector<std::string> tools = {};  ///< 1, or 2 for two hands; none: the only one
  LocalModel model = LocalModel::kPotential;
  double fast_hz = 2000.0;   ///< [Hz] [100, 20000]
  double slow_hz = 100.0;    ///< [Hz] [1, fast_hz]
  double force_max_n = 8.0;  ///< [N] > 0
  SimulatedDeviceConfig device = {};
  KeptSurface surface = {};  ///< what had stayed before
  /// Elements of a body whose responses are not in the database; outlives the session.
  ElementSender* growing = nullptr;
};

/// A device that holds the tool in a pointer's place.
struct HeldDevice {
  Device* device = nullptr;  ///< open; in the body's frame; outlives its use
  WireLimits wire = {};
  double rate_hz = 1000.0;   ///< [Hz] > 0 about as often as tick_at() is called
  double force_max_n = 5.0;  ///< [N] > 0
};

/// One thread. Time passes in advance() and tick_at() alone.
class ViewSession {
 public:
  static constexpr double kRampS = 0.1;  ///< [s]

  /// `database` must outlive the session. @throws InputError for options out of range,
  /// and as coupled_set() where tools have several contacts or are two.
  ViewSession(const ResponseDatabase& database, const ViewSessionOptions& options);

  /// What a page's hand wants: to hold its tool there, or to lift it off the body.
  /// @throws InputError for a hand that is not there, or a turn that nobody feels.
  void follow(const HandWish& wish);

  /// All hands lift their tools, along the normal of the nearest point; a needle along
  /// its channel.
  void let_go();

  /// @throws InputError for a setting that this body does not have; then none is
  /// changed.
  void set(const ViewRequest& request);

  /// Fast ticks pass, unless a fault has ended the run.
  void advance(std::int64_t ticks);

  /// The device holds the tool of the one hand from now on, in a new run whose forces
  /// grow from zero within kRampS. No pointer steers then.
  /// @param now_ns of the clock of tick_at().
  void hold_by(const HeldDevice& held, std::int64_t now_ns);

  /// A pointer holds it again, in a new run; where a fault has ended the run, from the
  /// next reset() on.
  void release();

  [[nodiscard]] bool is_held() const { return held_.device != nullptr; }

  /// Other limits of a held device's wire.
  void watch_wire(const WireLimits& limits) { fast_->watch_wires(limits); }

  /// A fast tick of a held device, unless a fault has ended the run. @param now_ns of
  /// any clock that does not go back.
  void tick_at(std::int64_t now_ns);

  /// [ns] Of that clock as the device's readings have it.
  [[nodiscard]] std::int64_t run_ns(std::int64_t now_ns) const {
    return now_ns - before_run_ns_;
  }

  /// A new run: clear of the body, faults and accounts gone, settings kept. The body is
  /// as it was at the start of the session: new dents are gone.
  void reset();

  [[nodiscard]] bool holding() const;   ///< some hand
  [[nodiscard]] bool touching() const;  ///< in the latest tick
  [[nodiscard]] Fault fault() const { return report().fault; }
  [[nodiscard]] std::int64_t ticks() const { return report().ticks; }  ///< of this run
  [[nodiscard]] double fast_hz() const { return options_.fast_hz; }    ///< [Hz]
  [[nodiscard]] double slow_hz() const { return options_.slow_hz; }  ///< at the moment
  [[nodiscard]] const ResponseDatabase& database() const { return database_; }
  /// Of the first tool.
  [[nodiscard]] const ResponseTable& table() const { return *hands_.front().table; }
  /// One for each hand, of tools of several contacts or of two hands; else none.
  [[nodiscard]] std::vector<const ResponseTable*> hand_tables() const;
  [[nodiscard]] const ViewSessionOptions& options() const noexcept { return options_; }
  [[nodiscard]] const RenderReport& report() const noexcept { return fast_->report(); }
  [[nodiscard]] const TickRecord& latest() const noexcept { return latest_; }
  [[nodiscard]] SteeredBody& body() noexcept { return *body_; }

  [[nodiscard]] ViewSettings settings() const;

  /// All that the session shows by itself.
  [[nodiscard]] ViewFrame frame();

  /// What has yielded until now.
  [[nodiscard]] KeptSurface kept() const { return body_->rendered().kept(); }

  /// All ticks since the last call, at most the kTicksKept latest.
  [[nodiscard]] std::vector<TickRecord> take_ticks();

 private:
  void seat(SteeredHand& hand, const ResponseTable& table, std::int32_t node);
  void start();
  void tick();
  void look_at_tick();
  void trim_ticks();
  [[nodiscard]] std::vector<Device*> seat_devices();
  void lift(std::size_t hand);
  [[nodiscard]] Eigen::Vector3d clear_of(std::size_t hand) const;

  const ResponseDatabase& database_;
  ViewSessionOptions options_;
  SurfaceSearch search_;
  std::vector<SteeredHand> hands_;  // which devices keep hold of
  std::unique_ptr<SteeredBody> body_;
  SimulatedClock clock_;
  std::vector<std::unique_ptr<SimulatedDevice>> devices_;
  HeldDevice held_;
  std::int64_t before_run_ns_ = 0;  // between a held device's clock and this one
  std::unique_ptr<Telemetry> telemetry_;
  std::unique_ptr<FastProcess> fast_;
  Deadlines fast_deadlines_;
  Deadlines slow_deadlines_;
  TickRecord latest_;
  std::vector<TickRecord> ticks_;
  FrictionTrail friction_;
  bool rubs_ = false;  // what the page shows
  std::int64_t slow_updates_ = 0;
};

/// What pages show of a session that a page steers. @param name of the database
[[nodiscard]] ViewedBody viewed(const ViewSession& session, std::string name);

}  // namespace palpate
