// The fast process of a tool that somebody else's loop drives: no device, no clock.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "runtime/c_api/body_placement.h"
#include "runtime/contacts/coupled_step.h"
#include "runtime/realtime/triple_buffer.h"
#include "runtime/render/rendered_body.h"

namespace palpate {

/// How a host measures, and what its device can do.
struct HostOptions {
  std::string tool = {};                      ///< empty: the only one
  LocalModel model = LocalModel::kPotential;  ///< a passive one
  double metres_per_unit = 1.0;               ///< [m] > 0
  double newtons_per_unit = 1.0;              ///< [N] > 0
  double position_gain = 1.0;          ///< [-] > 0 movement here per device movement
  double force_gain = 1.0;             ///< [-] > 0 device force per force here
  double tick_s = 0.001;               ///< [s] (0, 1]
  double slow_hz = 100.0;              ///< [Hz] [1, 1000]
  double damping_n_s_per_m = 0.0;      ///< [N s/m] >= 0 of the device; 0: unknown
  double angular_damping_n_m_s = 0.0;  ///< [N m s] >= 0 of its turns; 0: unknown
  double delay_s = 0.0;                ///< [s] >= 0 of the device
  double force_max_n = 8.0;            ///< [N] > 0 at the device
  double stall_s = 0.5;                ///< [s] > 0 in contact without an element: fault
  double ramp_s = 0.1;                 ///< [s] > 0 to the full force
  bool own_slow_steps = false;         ///< no slow thread
  bool limit_stiffness = false;        ///< scale forces instead of refusing
  bool streamed = false;               ///< the database stays in its file
  bool forces_alone = false;           ///< devices give no torque (palpate_step())
  // Of a scene that is computed meanwhile (served/join_scene.h).
  bool scene = false;     ///< the file is one
  bool estimate = false;  ///< where nothing is known: as of a half space
  std::filesystem::path server = {};
  std::filesystem::path output = {};
};

/// @throws InputError for the first value out of range.
void check(const HostOptions& options);

/// The model of that name, of those that create no energy: a host could not know of
/// the others'. @throws InputError naming the passive ones.
[[nodiscard]] LocalModel passive_model(std::string_view name);

/// Why a host cannot read a needle of a tool.
inline constexpr char kNoNeedle[] =
    "the tool is no needle: its database does not say what it punctures";

/// One tick of a host's tool, in its world.
struct HostTick {
  WrenchCommand command;
  FastContact contact;
  double work_j = 0.0;    ///< [J] by the ledger
  double tilt_rad = 0.0;  ///< [rad] [0, pi]
  std::uint64_t ticks = 0;
};

/// Position and orientation of a host's tool in its world, and the time since the last.
struct HostSample {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector4d quaternion = Eigen::Vector4d::Zero();  ///< x y z w; 0: none
  double dt_s = 0.0;                                     ///< [s] 0: nominal tick
  /// Of several contacts; else the tool turns at no gain (step_unturned()).
  bool torque_felt = true;
};

/// About 1 MB of one contact, 11 MB and 0.4 MB for each of several. Three threads at
/// most: the haptic one calls step(), delivered() and, outside a tick, reset(), the
/// slow one serve(), one reads latest(). The haptic functions do not allocate, lock,
/// throw or read a clock.
class HostTool {
 public:
  /// @param placement of the body in the world; outlives the tool. @param tick_s,
  /// stall_s as in HostOptions. @param tables names of its responses, which
  /// YieldedRow::table counts.
  HostTool(std::unique_ptr<RenderedBody> body, std::vector<std::string> tables,
           const BodyPlacement& placement, double tick_s, double stall_s)
      : body_(std::move(body)),
        tables_(std::move(tables)),
        placement_(placement),
        tick_s_(tick_s),
        stall_s_(stall_s) {}

  HostTick step(const HostSample& sample) noexcept {
    return step(std::span(&sample, 1));
  }

  /// One sample for each of hands(); the first one's dt_s and torque_felt count. Of
  /// several contacts a sample without an orientation has the tool's frame along the
  /// body's.
  HostTick step(std::span<const HostSample> samples) noexcept;

  /// What the devices made of the latest tick. @param made of each hand; of one contact
  /// the force counts. False, and nothing happens: not finite.
  bool delivered(const PortWrenches& made) noexcept;

  /// What the latest tick asked for, of each hand; of one contact no torque.
  [[nodiscard]] const PortWrenches& wanted() const noexcept { return wanted_; }

  /// Forgets fault, account, place and what relaxes; what has yielded stays.
  void reset() noexcept;

  /// What has yielded. Not while another thread steps.
  [[nodiscard]] KeptSurface kept() const { return body_->kept(); }

  [[nodiscard]] const std::vector<std::string>& tables() const noexcept {
    return tables_;
  }

  /// reset(), on a surface that has yielded so. @throws as RenderedBody::begin_with().
  void begin_with(const KeptSurface& kept);

  /// The latest tick; a default one before the first.
  [[nodiscard]] HostTick latest() noexcept;

  /// One turn of the slow process. @returns elements sent.
  std::size_t serve(std::int64_t now_ns) { return body_->serve(now_ns).value_or(0); }

  /// Of the latest tick, in the world; the haptic thread outside a tick.
  [[nodiscard]] int contacts() const noexcept { return body_->contacts(); }
  [[nodiscard]] BodyContact contact_at(int i) const noexcept;

  /// Of a needle, in the world; likewise.
  [[nodiscard]] NeedleSeen needle() const noexcept;
  /// A channel that the needle has opened. @param i [0, needle().state.channels)
  [[nodiscard]] Channel channel_at(std::int32_t i) const noexcept;

  /// Whether it touches at several places.
  [[nodiscard]] bool has_several() const noexcept { return body_->turns(); }
  [[nodiscard]] std::size_t hands() const noexcept { return body_->hands(); }

 private:
  [[nodiscard]] FastContact contact() const noexcept;
  [[nodiscard]] DeviceReading reading_of(const HostSample& sample) const noexcept;

  std::unique_ptr<RenderedBody> body_;
  std::vector<std::string> tables_;
  const BodyPlacement& placement_;
  double tick_s_;
  double stall_s_;
  PortWrenches wanted_;
  TripleBuffer<HostTick> latest_;
  double silent_s_ = 0.0;      // since the latest element
  std::int64_t time_ns_ = 0;   // sum of the steps, for the slow process
  std::int64_t sequence_ = 0;  // never goes back
  std::uint64_t ticks_ = 0;
};

}  // namespace palpate
