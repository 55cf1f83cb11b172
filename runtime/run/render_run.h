// Renders a database on a simulated device that a simulated hand holds.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "formats/recording/surface_state.h"
#include "runtime/account/local_model.h"
#include "runtime/attach/device_factory.h"
#include "runtime/device/link_report.h"
#include "runtime/device/stability_margin.h"
#include "runtime/hand/simulated_device.h"
#include "runtime/render/contacts_seen.h"
#include "runtime/render/friction_seen.h"
#include "runtime/render/needle_seen.h"
#include "runtime/render/render_report.h"
#include "runtime/render/telemetry.h"
#include "runtime/run/coupling_report.h"
#include "runtime/run/pressed_place.h"
#include "runtime/served/served_report.h"
#include "runtime/slow/file_elements.h"
#include "runtime/slow/memory_elements.h"

namespace palpate {

/// Where a run is recorded, and what the recording says of its database.
struct RecordingRequest {
  std::filesystem::path file = {};  ///< empty: not recorded
  std::filesystem::path flight_file =
      {};                            ///< the last seconds before a fault; empty: none
  std::string database = {};         ///< name of the file, without its folder
  std::string database_sha256 = {};  ///< of its content
};

/// The second of two hands that press one body together.
struct SecondHand {
  std::string tool;
  std::optional<Eigen::Vector3d> at_m = {};     ///< [m] where to press
  std::filesystem::path socket = {};            ///< as of the first
  std::optional<AttachedDevice> attached = {};  ///< likewise
};

struct SimulationOptions {
  std::string tool;                         ///< empty: the only one
  std::optional<SecondHand> together = {};  ///< whose contacts are coupled with these
  LocalModel model = LocalModel::kPotential;
  double duration_s = 10.0;  ///< [s] > 0
  double fast_hz = 2000.0;   ///< [Hz] > 0
  double slow_hz = 100.0;    ///< [Hz] > 0
  double force_max_n = 8.0;  ///< [N] > 0
  double ramp_s = 0.1;       ///< [s] >= 0 from the start until force_max_n is allowed
  int cpu = -1;              ///< for the fast thread in real time; -1: any
  std::optional<Eigen::Vector3d> at_m;  ///< [m] where to press
  bool real_time = false;
  bool limit_stiffness = false;  ///< scale forces to what the device can render
  // Of several contacts on simulated devices, whose hands feel torques.
  double tilt_rad = 0.1;  ///< [rad] [-1, 1] that each hand rocks its tool
  double turn_rad = 0.5;  ///< [rad] [-3, 3] that each turns it about the normal
  /// Poses instead of hands and devices (pose_trace.h); a tick lasts as long as between
  /// two of them. Empty: none.
  std::filesystem::path poses = {};
  /// Of every tick (pose_trace.h), kept in memory until the end; empty: none.
  std::filesystem::path trace = {};
  /// Hangs a tool of several contacts on the device; none: the device holds it.
  std::optional<VirtualCoupling> coupling = {};
  SimulatedDeviceConfig device;  ///< its tick_s and force_max_n are set by the run
  std::filesystem::path socket;  ///< a driver's instead of the simulated device
  std::optional<AttachedDevice> attached;  ///< instead of the simulated device
  /// [m/s] 0 or more: the simulated hand wanders over the body at this speed, pressing,
  /// instead of pressing one place.
  double wander_m_per_s = 0.0;
  RecordingRequest recording;
  TickQueue* watch = nullptr;  ///< every tick goes there, too; outlives the run
  /// Of a tool of several contacts, the latest one with all of them; likewise.
  ContactsWatch* watch_contacts = nullptr;
  NeedleWatch* watch_needle = nullptr;  ///< of a needle, the latest tick; likewise
  /// Of a tool that touches at one place, every tick; likewise.
  FrictionWatch* watch_friction = nullptr;
  /// What each tool of the body had left on it before; no tool: a fresh body.
  SurfaceState surface = {};
  /// Of the body, where a run before this one has found it.
  std::optional<RenderedStiffness> stiffness = {};
};

struct SimulationReport {
  SimulationOptions options;
  std::string tool;
  std::vector<std::string> tables;   ///< of its responses, and a second hand's
  std::string device;                ///< name
  std::string second_device;         ///< of a second hand; else empty
  bool device_turns = false;         ///< it measures how it is turned
  bool torque_felt = false;          ///< by who turns tools of several contacts
  std::string device_failure;        ///< why it was lost; empty if it was not
  std::int32_t node = -1;            ///< pressed
  std::int32_t second_node = -1;     ///< by the second hand
  PressedPlace place;                ///< that node, and the place asked for
  PressedPlace second_place;         ///< likewise
  int contacts = 1;                  ///< of the tools
  double table_error = 0.0;          ///< [-] of what couples them; 0: not stated
  bool convex = true;                ///< one equilibrium wherever it was tried
  double turning_n_m_per_rad = 0.0;  ///< stiffness of contacts together in turning
  RenderedStiffness stiffness;
  StabilityBounds bounds;
  double hold_s = 0.0;       ///< [s] time that a force is held, for the bounds
  double force_scale = 1.0;  ///< [-] < 1 where stiffness was limited
  std::optional<CouplingReport> coupling;  ///< of a virtual tool
  ResampleLoss resample_loss;
  std::optional<LinkReport> wire;         ///< of a device that has one
  std::optional<LinkReport> second_wire;  ///< of the second hand's
  std::optional<StreamReport> stream;     ///< of a body that was streamed
  std::optional<ServedReport> served;     ///< of a scene that is computed meanwhile
  std::uint64_t records_dropped = 0;      ///< by the recorder
  std::string recording_failure;          ///< why the recording ended early
  RenderReport render;
};

/// The names of all local models, with commas between them.
[[nodiscard]] std::string known_models();

/// The model that --model names. @throws InputError naming those that there are.
[[nodiscard]] LocalModel requested_model(const std::string& model);

/// Time between force updates [s]. The time is the slow period for the models that hold
/// the slow process's force, else the fast one. The time is no less than the wire's own
/// (DeviceLimits).
[[nodiscard]] double hold_s(LocalModel model, double fast_hz, double slow_hz,
                            double wire_s);

/// Checks the margin, then approaches, presses, slides and releases until the time is
/// over or `stop` is set. @throws InputError for options out of range, a tool that is
/// not there, and, without limit_stiffness, a body that the device cannot render,
/// saying why.
[[nodiscard]] SimulationReport simulate(const ResponseDatabase& database,
                                        const SimulationOptions& options,
                                        const std::atomic<bool>& stop);

/// Several tools of the database at once, each in a hand of its own on a device of its
/// own. One slow process serves all (render_loop.h). @param tools the options of each;
/// the same clock, duration and slow rate. @returns a report each.
[[nodiscard]] std::vector<SimulationReport> simulate(
    const ResponseDatabase& database, std::span<const SimulationOptions> tools,
    const std::atomic<bool>& stop);

/// The same with responses that stay in the file but for `budget_bytes`, of which every
/// tool has its share. Each presses the node nearest to its at_m, or the highest one
/// with a response. The margin's friction is that of the tool, because the index has
/// none of the nodes. @throws FormatError also for a damaged chunk that the start
/// needs; a later one is the report's fault.
[[nodiscard]] std::vector<SimulationReport> simulate_streamed(
    const std::filesystem::path& file, std::span<const SimulationOptions> tools,
    std::size_t budget_bytes, const std::atomic<bool>& stop);

/// A scene whose responses come while it is rendered, in real time. The margin is kept
/// answer by answer: one that is stiffer than what the device renders is softened.
/// Presses the reachable vertex nearest to at_m, or the highest one.
/// @throws as simulate(), and as ServedClient::scene().
[[nodiscard]] SimulationReport simulate_served(ServedClient& client,
                                               const SimulationOptions& options,
                                               const std::atomic<bool>& stop);

/// The same with elements that others look at. @param elements of body_of() the scene
/// and the client's tool; nothing was handed over to them.
[[nodiscard]] SimulationReport simulate_served(ServedClient& client,
                                               const SimulationOptions& options,
                                               const std::atomic<bool>& stop,
                                               GrowingElements& elements);

/// The report for people, aligned lines.
[[nodiscard]] std::string summary(const SimulationReport& report);

}  // namespace palpate
