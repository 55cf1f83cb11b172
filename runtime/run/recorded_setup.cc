#include "runtime/run/recorded_setup.h"

#include <optional>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/recording/surface_state.h"
#include "runtime/render/one_contact.h"
#include "runtime/render/several_contacts.h"

namespace palpate {
namespace {

LocalModel model_of(const RecordingHeader& header) {
  const auto model = local_model(header.model);
  if (!model) {
    throw FormatError(
        fmt::format("recording: model {:?} is not a local model", header.model));
  }
  return *model;
}

void put_coupling(const VirtualCoupling& coupling, RecordingHeader& header) {
  header.coupling_mass_kg = coupling.mass_kg;
  header.coupling_inertia_x_kg_m2 = coupling.inertia_kg_m2.x();
  header.coupling_inertia_y_kg_m2 = coupling.inertia_kg_m2.y();
  header.coupling_inertia_z_kg_m2 = coupling.inertia_kg_m2.z();
  header.coupling_spring_n_per_m = coupling.spring_n_per_m;
  header.coupling_spring_n_m_per_rad = coupling.spring_n_m_per_rad;
  header.coupling_damper_n_s_per_m = coupling.damper_n_s_per_m;
  header.coupling_damper_n_m_s = coupling.damper_n_m_s;
  header.coupling_lever_m = coupling.lever_m;
}

std::optional<VirtualCoupling> coupling_of(const RecordingHeader& header) {
  if (header.coupling_mass_kg == 0.0) {
    return std::nullopt;
  }
  return VirtualCoupling{.mass_kg = header.coupling_mass_kg,
                         .inertia_kg_m2 = {header.coupling_inertia_x_kg_m2,
                                           header.coupling_inertia_y_kg_m2,
                                           header.coupling_inertia_z_kg_m2},
                         .spring_n_per_m = header.coupling_spring_n_per_m,
                         .spring_n_m_per_rad = header.coupling_spring_n_m_per_rad,
                         .damper_n_s_per_m = header.coupling_damper_n_s_per_m,
                         .damper_n_m_s = header.coupling_damper_n_m_s,
                         .lever_m = header.coupling_lever_m};
}

}  // namespace

RecordingHeader recording_header(const SimulationReport& report,
                                 const FastProcessConfig& config,
                                 const DeviceLimits& limits, const RenderedBody* body) {
  const SimulationOptions& options = report.options;
  RecordingHeader header{.writer = "palpate-run " PALPATE_VERSION,
                         .database = options.recording.database,
                         .database_sha256 = options.recording.database_sha256,
                         .tool = report.tool,
                         .second_tool = options.together ? options.together->tool : "",
                         .model = std::string(name(config.fast.model)),
                         .clock = options.real_time ? "real" : "simulated",
                         .device = report.device,
                         .fast_hz = config.rate_hz,
                         .slow_hz = options.slow_hz,
                         .force_scale = report.force_scale,
                         .tool_radius_m = config.fast.tool_radius_m,
                         .force_max_n = config.fast.force_max_n,
                         .slew_max_n_per_s = config.fast.slew_max_n_per_s,
                         .energy_floor_j = config.fast.energy_floor_j,
                         .recovery_m_per_s = config.fast.recovery_m_per_s,
                         .ramp_s = config.fast.ramp_s,
                         .device_damping_n_s_per_m = limits.damping_n_s_per_m,
                         .device_coulomb_n = limits.coulomb_n,
                         .device_resolution_m = limits.resolution_m,
                         .device_delay_s = limits.delay_s,
                         .surface = surface_of(options.surface, report.tables)};
  if (body != nullptr) {
    header.poses = 1.0;
    header.torque_felt = body->torque_felt() ? 1.0 : 0.0;
  }
  if (report.coupling) {
    put_coupling(report.coupling->coupling, header);
  }
  return header;
}

FastConfig fast_config(const RecordingHeader& header) {
  const FastConfig config{.model = model_of(header),
                          .tool_radius_m = header.tool_radius_m,
                          .force_max_n = header.force_max_n,
                          .slew_max_n_per_s = header.slew_max_n_per_s,
                          .energy_floor_j = header.energy_floor_j,
                          .recovery_m_per_s = header.recovery_m_per_s,
                          .ramp_s = header.ramp_s};
  if (const char* wrong = check(config)) {
    throw FormatError(fmt::format("recording: {}", wrong));
  }
  return config;
}

ReplayedBody::ReplayedBody(const RecordingHeader& header,
                           const ResponseDatabase& database, LocalModel model) {
  FastConfig config = fast_config(header);
  config.model = model;
  const ResponseTable& first = find_tool(database, header.tool);
  if (header.poses == 0.0) {
    stream_ = std::make_unique<ElementStream>(database, first, header.force_scale);
    body_ = std::make_unique<OneContact>(config, *stream_);
  } else {
    std::vector<const ResponseTable*> tools{&first};
    if (!header.second_tool.empty()) {
      tools.push_back(&find_tool(database, header.second_tool));
    }
    body_ = std::make_unique<SeveralContacts>(
        database, tools, config,
        ContactsHeld{.force_scale = header.force_scale,
                     .coupling = coupling_of(header),
                     .torque_felt = header.torque_felt != 0.0});
  }
  body_->begin_with(header.surface);
}

}  // namespace palpate
