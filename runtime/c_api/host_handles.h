// What the C interface's opaque pointers point to.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "runtime/c_api/host_body.h"
#include "runtime/c_api/palpate.h"

namespace palpate {

/// How a body stands in its host's world: x_world = turn x_body + origin.
struct Placement {
  bool placed = false;  ///< else the world's frame is the body's, bit for bit
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d point_in_body(const Eigen::Vector3d& x_m) const {
    return placed ? Eigen::Vector3d(rotation.transpose() * (x_m - origin_m)) : x_m;
  }
  [[nodiscard]] Eigen::Vector3d point_in_world(const Eigen::Vector3d& x_m) const {
    return placed ? Eigen::Vector3d(rotation * x_m + origin_m) : x_m;
  }
  /// Of a force, torque or normal.
  [[nodiscard]] Eigen::Vector3d vector_in_world(const Eigen::Vector3d& v) const {
    return placed ? Eigen::Vector3d(rotation * v) : v;
  }
};

}  // namespace palpate

struct palpate_tool {
  palpate::HostTool& tool;
  const palpate::HostBody& body;
  const palpate::Placement& placement;
  double metres_per_unit;
  double newtons_per_unit;
  double force_scale;
  const palpate::GrowingElements* grown = nullptr;  // of a scene
};

struct palpate_body {
  palpate_body(const char* file, const palpate::HostOptions& options)
      : body(file, options) {}
  palpate::HostBody body;
  palpate::Placement placement;
  std::mutex mutex;  // of `tools`
  std::vector<std::unique_ptr<palpate_tool>> tools;
};
