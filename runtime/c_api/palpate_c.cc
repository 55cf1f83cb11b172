// The C interface over HostBody: no exception gets out, no struct is larger than the
// caller's.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/hdf5/hdf5_io.h"
#include "runtime/c_api/given_options.h"
#include "runtime/c_api/host_body.h"
#include "runtime/c_api/host_surface.h"
#include "runtime/c_api/palpate.h"
#include "runtime/c_api/told_service.h"

struct palpate_tool {
  palpate::HostTool& tool;
  const palpate::HostBody& body;
  double metres_per_unit;
  double newtons_per_unit;
  double force_scale;
  bool two_hands = false;
  const palpate::GrowingElements* grown = nullptr;  // of a scene
};

struct palpate_body {
  palpate_body(const char* file, const palpate::HostOptions& options)
      : body(file, options) {}
  palpate::HostBody body;
  std::mutex mutex;  // of `tools`
  std::vector<std::unique_ptr<palpate_tool>> tools;
};

namespace {

using palpate::HostOptions;
using palpate::InputError;

void copy_text(std::string_view text, char* to, std::size_t bytes) noexcept {
  if (to != nullptr && bytes > 0) {
    const std::size_t kept = std::min(text.size(), bytes - 1);
    std::memcpy(to, text.data(), kept);
    to[kept] = '\0';
  }
}

int error_of(int exit_code) noexcept {
  switch (exit_code) {
    case 2:
      return PALPATE_ERROR_INPUT;
    case 3:
      return PALPATE_ERROR_FORMAT;
    default:
      return PALPATE_ERROR_INTERNAL;
  }
}

// Calls `work`; an exception becomes an error and a line of text.
template <typename Work>
int guarded(char* error, std::size_t error_bytes, Work work) noexcept {
  try {
    return work();
  } catch (const palpate::Error& failure) {
    copy_text(failure.what(), error, error_bytes);
    return error_of(failure.exit_code());
  } catch (const std::exception& failure) {
    copy_text(failure.what(), error, error_bytes);
  } catch (...) {
    copy_text("unknown exception", error, error_bytes);
  }
  return PALPATE_ERROR_INTERNAL;
}

int status_of(const palpate::TickAccount& command) noexcept {
  if (command.fault != 0) {
    return -static_cast<int>(command.fault);
  }
  return command.in_contact ? PALPATE_CONTACT : PALPATE_FREE;
}

void copy(const Eigen::Vector3d& from, double per_unit, double* to) noexcept {
  Eigen::Map<Eigen::Vector3d> view(to);
  view = from / per_unit;
}

void zero(double* values, std::size_t count) noexcept {
  if (values != nullptr) {
    std::fill_n(values, count, 0.0);
  }
}

// As much of a struct as its caller knows; what it knows beyond is zero.
template <typename Struct>
void copy_known(const Struct& all, Struct* to) noexcept {
  const std::size_t bytes = all.struct_size;
  std::memcpy(to, &all, std::min(bytes, sizeof(all)));
  if (bytes > sizeof(all)) {
    std::memset(reinterpret_cast<unsigned char*>(to) + sizeof(all), 0,
                bytes - sizeof(all));
  }
}

// Of one hand. @param quat_xyzw may be null.
palpate::HostSample sample_of(const palpate_tool& tool, const double* position,
                              const double* quat_xyzw, double dt_s,
                              bool torque_felt) noexcept {
  palpate::HostSample sample;
  sample.position_m =
      tool.metres_per_unit * Eigen::Map<const Eigen::Vector3d>(position);
  if (quat_xyzw != nullptr) {
    sample.quaternion = Eigen::Map<const Eigen::Vector4d>(quat_xyzw);
  }
  sample.dt_s = dt_s;
  sample.torque_felt = torque_felt;
  return sample;
}

// @param torque_out may be null.
void copy_wrench(const palpate_tool& tool, const palpate::Wrench& wrench,
                 double* force_out, double* torque_out) noexcept {
  copy(wrench.force_n, tool.newtons_per_unit, force_out);
  if (torque_out != nullptr) {
    copy(wrench.torque_n_m, tool.newtons_per_unit * tool.metres_per_unit, torque_out);
  }
}

// One tick. @param torque_out may be null.
int render(palpate_tool* tool, const double* position, const double* quat_xyzw,
           double dt_s, double* force_out, double* torque_out) noexcept {
  zero(force_out, 3);
  if (tool == nullptr || position == nullptr || force_out == nullptr ||
      tool->two_hands) {
    return PALPATE_ERROR_INPUT;
  }
  const palpate::HostTick tick = tool->tool.step(
      sample_of(*tool, position, quat_xyzw, dt_s, torque_out != nullptr));
  copy_wrench(*tool, tick.command.wrench[0], force_out, torque_out);
  return status_of(tick.command);
}

// Hands a new tool of the body to its host. @param add gives the tool.
template <typename Add>
palpate_tool* open_tool(palpate_body* body, char* error, std::size_t error_bytes,
                        bool two_hands, Add add) noexcept {
  copy_text("", error, error_bytes);
  palpate_tool* tool = nullptr;
  guarded(error, error_bytes, [&] {
    if (body == nullptr) {
      throw InputError("no body: the pointer is null");
    }
    const std::scoped_lock lock(body->mutex);
    body->tools.reserve(palpate::kHostToolsMax);
    const HostOptions& options = body->body.options();
    const palpate::HostBody::Together added = add();
    body->tools.push_back(std::unique_ptr<palpate_tool>(new palpate_tool{
        added.tool, body->body, options.metres_per_unit, options.newtons_per_unit,
        added.force_scale, two_hands, body->body.grown(added.tool)}));
    tool = body->tools.back().get();
    return 0;
  });
  return tool;
}

}  // namespace

int palpate_abi_version(void) {
  return PALPATE_ABI_VERSION;
}

palpate_body* palpate_open(const char* file, const palpate_options* options,
                           char* error, size_t error_bytes) {
  copy_text("", error, error_bytes);
  palpate_body* body = nullptr;
  guarded(error, error_bytes, [&] {
    if (file == nullptr) {
      throw InputError("no file is named: the pointer is null");
    }
    body = new palpate_body(file, palpate::host_options(options));
    return 0;
  });
  return body;
}

palpate_tool* palpate_tool_add(palpate_body* body) {
  return palpate_tool_open(body, nullptr, 0);
}

palpate_tool* palpate_tool_open(palpate_body* body, char* error, size_t error_bytes) {
  return open_tool(body, error, error_bytes, false, [&] {
    return palpate::HostBody::Together{body->body.add_tool(), body->body.force_scale()};
  });
}

palpate_tool* palpate_together_open(palpate_body* body, const char* second_tool,
                                    char* error, size_t error_bytes) {
  return open_tool(body, error, error_bytes, true, [&] {
    return body->body.add_together(second_tool == nullptr ? "" : second_tool);
  });
}

int palpate_service_get(palpate_body* body, palpate_service* service) {
  if (service == nullptr || service->struct_size < sizeof(size_t)) {
    return PALPATE_ERROR_INPUT;
  }
  return guarded(nullptr, 0, [&] {
    if (body == nullptr) {
      throw InputError("no body");
    }
    palpate_service all = palpate::told_service(body->body);
    all.struct_size = service->struct_size;
    copy_known(all, service);
    return 0;
  });
}

int palpate_slow_step(palpate_body* body) {
  return guarded(nullptr, 0, [&] {
    if (body == nullptr) {
      throw InputError("no body");
    }
    const int sent = static_cast<int>(body->body.slow_step());
    const palpate::SlowFailure failure = body->body.slow_failure();
    return failure.exit_code == 0 ? sent : error_of(failure.exit_code);
  });
}

int palpate_slow_failure(palpate_body* body, char* text, size_t text_bytes) {
  copy_text("", text, text_bytes);
  return guarded(text, text_bytes, [&] {
    if (body == nullptr) {
      throw InputError("no body: the pointer is null");
    }
    const palpate::SlowFailure failure = body->body.slow_failure();
    copy_text(failure.text, text, text_bytes);
    return failure.exit_code == 0 ? 0 : error_of(failure.exit_code);
  });
}

int palpate_force(palpate_tool* tool, const double position[3],
                  const double quat_xyzw[4], double dt_s, double force_out[3]) {
  return render(tool, position, quat_xyzw, dt_s, force_out, nullptr);
}

int palpate_wrench(palpate_tool* tool, const double position[3],
                   const double quat_xyzw[4], double dt_s, double force_out[3],
                   double torque_out[3]) {
  zero(force_out, 3);
  zero(torque_out, 3);
  if (torque_out == nullptr) {
    return PALPATE_ERROR_INPUT;
  }
  return render(tool, position, quat_xyzw, dt_s, force_out, torque_out);
}

int palpate_together(palpate_tool* tool, const double positions[6],
                     const double quats_xyzw[8], double dt_s, double forces_out[6],
                     double torques_out[6]) {
  zero(forces_out, 6);
  zero(torques_out, 6);
  if (tool == nullptr || positions == nullptr || forces_out == nullptr ||
      !tool->two_hands) {
    return PALPATE_ERROR_INPUT;
  }
  const bool turned = quats_xyzw != nullptr;
  const bool felt = torques_out != nullptr;
  const std::array<palpate::HostSample, 2> samples{
      sample_of(*tool, positions, quats_xyzw, dt_s, felt),
      sample_of(*tool, positions + 3, turned ? quats_xyzw + 4 : nullptr, dt_s, felt)};
  const palpate::HostTick tick = tool->tool.step(samples);
  copy_wrench(*tool, tick.command.wrench[0], forces_out, torques_out);
  copy_wrench(*tool, tick.command.wrench[1], forces_out + 3,
              torques_out == nullptr ? nullptr : torques_out + 3);
  return status_of(tick.command);
}

int palpate_delivered(palpate_tool* tool, const double* force, const double* torque) {
  if (tool == nullptr || force == nullptr) {
    return PALPATE_ERROR_INPUT;
  }
  palpate::PortWrenches made = tool->tool.wanted();
  for (std::size_t hand = 0; hand < (tool->two_hands ? 2U : 1U); ++hand) {
    made[hand].force_n =
        tool->newtons_per_unit * Eigen::Map<const Eigen::Vector3d>(force + 3 * hand);
    if (torque != nullptr) {
      made[hand].torque_n_m = tool->newtons_per_unit * tool->metres_per_unit *
                              Eigen::Map<const Eigen::Vector3d>(torque + 3 * hand);
    }
  }
  return tool->tool.delivered(made) ? 0 : PALPATE_ERROR_INPUT;
}

double palpate_needed_damping(const palpate_body* body) {
  return body == nullptr ? 0.0 : body->body.needed_damping_n_s_per_m();
}

void palpate_hdf5_lock(void) {
  palpate::lock_hdf5();
}

void palpate_hdf5_unlock(void) {
  palpate::unlock_hdf5();
}

void palpate_state_get(palpate_tool* tool, palpate_state* state) {
  if (tool == nullptr || state == nullptr || state->struct_size < sizeof(size_t)) {
    return;
  }
  const palpate::HostTick tick = tool->tool.latest();
  palpate_state all{};
  all.struct_size = state->struct_size;
  all.status = status_of(tick.command);
  all.triangle = tick.contact.triangle;
  copy(tick.contact.point_m, tool->metres_per_unit, all.contact_point);
  copy(tick.contact.normal, 1.0, all.normal);
  all.depth = tick.command.depth_m / tool->metres_per_unit;
  all.work_j = tick.work_j;
  all.stored_j = tick.command.stored_j;
  all.tank_j = tick.command.tank_j;
  all.dissipated_j = tick.command.dissipated_j;
  all.relaxed_shift = tick.command.relaxed_shift_m / tool->metres_per_unit;
  all.force_scale = tool->force_scale;
  all.tilt_rad = tick.tilt_rad;
  all.starved = tick.command.starved ? 1 : 0;
  all.extrapolated = tick.command.extrapolated ? 1 : 0;
  all.ticks = tick.ticks;
  all.memory_j = tick.command.memory_j;
  all.relaxed_force = tick.command.carried_n / tool->newtons_per_unit;
  all.yielded_j = tick.command.yielded_j;
  copy_wrench(*tool, tick.command.wrench[0], all.force, all.torque);
  copy_wrench(*tool, tick.command.wrench[1], all.second_force, all.second_torque);
  all.contacts = tick.command.contacts;
  all.coupling_scaled = tick.command.scaled ? 1 : 0;
  all.dent = tick.command.dent_m / tool->metres_per_unit;
  all.answer = tool->grown == nullptr ? PALPATE_ANSWER_GOOD
                                      : static_cast<std::int32_t>(tool->grown->here());
  copy_known(all, state);
}

void palpate_reset(palpate_tool* tool) {
  if (tool != nullptr) {
    tool->tool.reset();
  }
}

int palpate_surface_save(palpate_tool* tool, const char* file, char* error,
                         size_t error_bytes) {
  copy_text("", error, error_bytes);
  return guarded(error, error_bytes, [&] {
    if (tool == nullptr || file == nullptr) {
      throw InputError("no tool or no file: a pointer is null");
    }
    palpate::save_surface(tool->body, tool->tool, file);
    return 0;
  });
}

int palpate_surface_load(palpate_tool* tool, const char* file, char* error,
                         size_t error_bytes) {
  copy_text("", error, error_bytes);
  return guarded(error, error_bytes, [&] {
    if (tool == nullptr) {
      throw InputError("no tool: the pointer is null");
    }
    palpate::load_surface(tool->body, tool->tool,
                          file == nullptr ? std::optional<std::filesystem::path>()
                                          : std::filesystem::path(file));
    return 0;
  });
}

void palpate_close(palpate_body* body) {
  delete body;
}
