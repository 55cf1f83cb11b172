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
#include "formats/base/utf8_path.h"
#include "formats/hdf5/hdf5_lock.h"
#include "runtime/c_api/given_options.h"
#include "runtime/c_api/guarded.h"
#include "runtime/c_api/host_handles.h"
#include "runtime/c_api/host_surface.h"
#include "runtime/c_api/known_struct.h"
#include "runtime/c_api/service_status.h"

namespace {

using palpate::copy_text;
using palpate::error_of;
using palpate::guarded;
using palpate::HostOptions;
using palpate::InputError;

// Hands a new tool of the body to its host. @param add gives the tool.
template <typename Add>
palpate_tool* open_tool(palpate_body* body, char* error, std::size_t error_bytes,
                        Add add) noexcept {
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
        added.force_scale, body->body.grown(added.tool)}));
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
    body =
        new palpate_body(palpate::path_of_utf8(file), palpate::host_options(options));
    return 0;
  });
  return body;
}

palpate_tool* palpate_tool_add(palpate_body* body) {
  return palpate_tool_open(body, nullptr, 0);
}

palpate_tool* palpate_tool_open(palpate_body* body, char* error, size_t error_bytes) {
  return open_tool(body, error, error_bytes, [&] {
    return palpate::HostBody::Together{body->body.add_tool(), body->body.force_scale()};
  });
}

palpate_tool* palpate_together_open(palpate_body* body, const char* second_tool,
                                    char* error, size_t error_bytes) {
  return open_tool(body, error, error_bytes, [&] {
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
    palpate_service all = palpate::service_status(body->body);
    all.struct_size = service->struct_size;
    palpate::copy_known(all, service);
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

double palpate_needed_damping(const palpate_body* body) {
  return body == nullptr ? 0.0 : body->body.needed_damping_n_s_per_m();
}

void palpate_hdf5_lock(void) {
  palpate::lock_hdf5();
}

void palpate_hdf5_unlock(void) {
  palpate::unlock_hdf5();
}

int palpate_place(palpate_body* body, const double position[3],
                  const double quat_xyzw[4]) {
  if (body == nullptr || position == nullptr) {
    return PALPATE_ERROR_INPUT;
  }
  Eigen::Vector4d turn(0.0, 0.0, 0.0, 1.0);
  if (quat_xyzw != nullptr) {
    turn = Eigen::Map<const Eigen::Vector4d>(quat_xyzw);
  }
  const bool placed =
      body->body.placement().place(body->body.options().metres_per_unit *
                                       Eigen::Map<const Eigen::Vector3d>(position),
                                   turn);
  return placed ? 0 : PALPATE_ERROR_INPUT;
}

int palpate_mesh_count(const palpate_body* body, size_t* vertices, size_t* triangles) {
  const palpate::SurfaceMesh* mesh = body == nullptr ? nullptr : body->body.mesh();
  if (mesh == nullptr || vertices == nullptr || triangles == nullptr) {
    return PALPATE_ERROR_INPUT;
  }
  *vertices = static_cast<size_t>(mesh->position_m.rows());
  *triangles = static_cast<size_t>(mesh->triangle.rows());
  return 0;
}

int palpate_mesh_get(const palpate_body* body, double* vertices, int32_t* triangles) {
  const palpate::SurfaceMesh* mesh = body == nullptr ? nullptr : body->body.mesh();
  if (mesh == nullptr) {
    return PALPATE_ERROR_INPUT;
  }
  for (Eigen::Index i = 0; vertices != nullptr && i < mesh->position_m.rows(); ++i) {
    Eigen::Map<Eigen::Vector3d> at(vertices + 3 * i);
    at = body->body.placement().point_in_world(mesh->position_m.row(i).transpose()) /
         body->body.options().metres_per_unit;
  }
  for (Eigen::Index i = 0; triangles != nullptr && i < mesh->triangle.rows(); ++i) {
    for (Eigen::Index corner = 0; corner < 3; ++corner) {
      triangles[3 * i + corner] = mesh->triangle(i, corner);
    }
  }
  return 0;
}

int palpate_query(palpate_body* body, const double* positions, size_t count,
                  double* forces_out, char* error, size_t error_bytes) {
  copy_text("", error, error_bytes);
  return guarded(error, error_bytes, [&] {
    if (body == nullptr ||
        (count > 0 && (positions == nullptr || forces_out == nullptr))) {
      throw InputError("no body, positions or forces: a pointer is null");
    }
    const HostOptions& options = body->body.options();
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
    const auto n = static_cast<Eigen::Index>(count);
    const palpate::Points at =
        options.metres_per_unit * Eigen::Map<const Rows>(positions, n, 3);
    Eigen::Map<Rows>(forces_out, n, 3) =
        body->body.static_forces_n(at) / options.newtons_per_unit;
    return 0;
  });
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
    palpate::save_surface(tool->body, tool->tool, palpate::path_of_utf8(file));
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
                                          : palpate::path_of_utf8(file));
    return 0;
  });
}

void palpate_close(palpate_body* body) {
  delete body;
}
