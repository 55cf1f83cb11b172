// What the C interface's opaque pointers point to.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "runtime/c_api/host_body.h"
#include "runtime/c_api/palpate.h"

namespace palpate {

/// In a host's units. @param to (3)
inline void copy_vector(const Eigen::Vector3d& from, double per_unit,
                        double* to) noexcept {
  Eigen::Map<Eigen::Vector3d>(to, 3) = from / per_unit;
}

}  // namespace palpate

struct palpate_tool {
  palpate::HostTool& tool;
  const palpate::HostBody& body;
  double metres_per_unit;
  double newtons_per_unit;
  double force_scale;
  const palpate::GrowingElements* grown = nullptr;  // of a scene
};

struct palpate_body {
  palpate_body(const palpate::StoredSource& file, const palpate::HostOptions& options)
      : body(file, options) {}
  palpate::HostBody body;
  std::mutex mutex;  // of `tools`
  std::vector<std::unique_ptr<palpate_tool>> tools;
};
