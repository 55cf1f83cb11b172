// Renders a tool of several contacts, or two hands that press one body together, on
// simulated devices: in simulated time, so that the same input gives the same bits.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "runtime/account/local_model.h"
#include "runtime/contacts/coupled_step.h"
#include "runtime/device/wrench_margin.h"
#include "runtime/hand/simulated_device.h"
#include "runtime/run/coupling_report.h"
#include "runtime/run/pose_trace.h"

namespace palpate {

struct ContactRunOptions {
  std::vector<std::string> tools;             ///< 1, or 2 for two hands
  LocalModel model = LocalModel::kPotential;  ///< a field
  double duration_s = 10.0;                   ///< [s] > 0
  double fast_hz = 2000.0;                    ///< [Hz] > 0
  double slow_hz = 100.0;                     ///< [Hz] > 0, at most the fast rate
  double force_max_n = 8.0;                   ///< [N] > 0
  double ramp_s = 0.1;                        ///< [s] >= 0
  std::vector<Eigen::Vector3d> at_m;  ///< [m] where each presses; empty: anywhere
  double tilt_rad = 0.1;              ///< [rad] that each hand rocks its tool
  double turn_rad = 0.5;              ///< [rad] that each turns it about the normal
  bool limit_stiffness = false;
  /// Hangs each tool on its device; none: the device holds it.
  std::optional<VirtualCoupling> coupling;
  SimulatedDeviceConfig device;
  std::filesystem::path trace;  ///< of every tick (pose_trace.h); empty: none
  /// Poses of every tick instead of hands and devices; empty: none. Its times are the
  /// ticks'.
  std::filesystem::path poses;
  std::vector<PoseTick> given;        ///< the same from memory; goes before `poses`
  std::optional<double> force_scale;  ///< [-] (0, 1] whatever the device can render
  bool keep = false;                  ///< the report holds every tick
};

struct ContactRunReport {
  ContactRunOptions options;
  std::optional<CouplingReport> coupling;
  std::vector<std::string> tools;  ///< rendered
  std::vector<PoseTick> kept;      ///< every tick, if options.keep
  int contacts = 0;
  std::vector<std::int32_t> node;  ///< that each hand presses
  /// Of the worst hand; with a coupling its spring's.
  WrenchMargin margin;
  double force_scale = 1.0;  ///< [-] below 1 where stiffness was limited
  bool convex = false;       ///< as the tables say
  double table_error = 0.0;  ///< [-] as the tables say; 0: not known
  std::int64_t ticks = 0;
  std::int64_t contact_ticks = 0;
  std::int64_t starved_ticks = 0;
  std::int64_t scaled_ticks = 0;  ///< with a coupling that is not whole
  std::int32_t contacts_max = 0;  ///< that carried something at once
  double depth_max_m = 0.0;
  double force_max_n = 0.0;
  double torque_max_n_m = 0.0;
  /// [J] by hands and devices against wrenches as they were held, as the tools really
  /// moved; of poses, as they were measured.
  double hand_net_j = 0.0;
  double model_work_j = 0.0;   ///< [J] by the ledger, at the end
  double lowest_work_j = 0.0;  ///< [J] least that it ever was
  double stored_j = 0.0;
  double tank_j = 0.0;
  bool relaxes = false;        ///< the body does
  double memory_j = 0.0;       ///< [J] in dents at the end
  double carried_max_n = 0.0;  ///< [N] most that had relaxed of all contacts' forces
  double dissipated_j = 0.0;
  bool yields = false;     ///< the body does
  double yielded_j = 0.0;  ///< [J] dissipated by it
  double relaxed_shift_max_m = 0.0;
  std::uint64_t interventions = 0;
  std::uint64_t elements_dropped = 0;
  Fault fault = Fault::kNone;
};

/// @throws InputError as coupled_set(), script_at() and read_poses() do, for options
/// out of range, and, without limit_stiffness, for a tool that the device cannot render
/// (wrench_margin.h). Limited is the coupling's spring where there is one, else forces.
[[nodiscard]] ContactRunReport simulate_contacts(const ResponseDatabase& database,
                                                 const ContactRunOptions& options,
                                                 const std::atomic<bool>& stop);

/// Whether a run of these tools is one of contacts: several tools that shall press
/// together, or one that has a contact set.
[[nodiscard]] bool is_contact_run(const ResponseDatabase& database,
                                  const std::vector<std::string>& tools, bool together);

[[nodiscard]] std::string summary(const ContactRunReport& report);
[[nodiscard]] std::string to_json(const ContactRunReport& report);

}  // namespace palpate
