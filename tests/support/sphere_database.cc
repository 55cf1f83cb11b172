#include "tests/support/sphere_database.h"

#include <cmath>
#include <numbers>

namespace palpate {
namespace {

constexpr double kRadius = 0.1;

SurfaceMesh ringed_sphere(std::int32_t rings) {
  const std::int32_t around = 2 * rings;
  const std::int32_t n = 2 + rings * around;
  SurfaceMesh mesh;
  mesh.position_m.resize(n, 3);
  mesh.position_m.row(0) << 0, 0, kRadius;
  mesh.position_m.row(n - 1) << 0, 0, -kRadius;
  const auto node = [&](std::int32_t ring, std::int32_t i) {
    return 1 + ring * around + i % around;
  };
  for (std::int32_t ring = 0; ring < rings; ++ring) {
    const double theta = std::numbers::pi * (ring + 1) / (rings + 1);
    for (std::int32_t i = 0; i < around; ++i) {
      const double phi = 2.0 * std::numbers::pi * i / around;
      mesh.position_m.row(node(ring, i)) << kRadius * std::sin(theta) * std::cos(phi),
          kRadius * std::sin(theta) * std::sin(phi), kRadius * std::cos(theta);
    }
  }
  mesh.triangle.resize(2 * n - 4, 3);
  Eigen::Index t = 0;
  for (std::int32_t i = 0; i < around; ++i) {
    mesh.triangle.row(t++) << 0, node(0, i), node(0, i + 1);
    mesh.triangle.row(t++) << n - 1, node(rings - 1, i + 1), node(rings - 1, i);
    for (std::int32_t ring = 0; ring + 1 < rings; ++ring) {
      mesh.triangle.row(t++) << node(ring, i), node(ring + 1, i), node(ring + 1, i + 1);
      mesh.triangle.row(t++) << node(ring, i), node(ring + 1, i + 1), node(ring, i + 1);
    }
  }
  return mesh;
}

}  // namespace

ResponseDatabase sphere_database(std::int32_t rings, int samples) {
  ResponseDatabase database;
  database.body = ringed_sphere(rings);
  database.normal = database.body.position_m.rowwise().normalized();
  std::vector<NodeResponse> responses(
      static_cast<std::size_t>(database.body.position_m.rows()));
  for (std::size_t i = 0; i < responses.size(); ++i) {
    const Eigen::Vector3d x =
        database.normal.row(static_cast<Eigen::Index>(i)).transpose();
    NodeResponse& response = responses[i];
    response.direction = x;
    response.origin = ResponseOrigin::kSimulated;
    response.error_relative = 0.01 * (1.0 + x.y() * x.y());
    const double k = 2000.0 * (1.5 + x.x() * std::sin(3.0 * x.z()));
    for (int j = 0; j < samples; ++j) {
      const double t = static_cast<double>(j) / (samples - 1);
      const double depth = 0.005 * std::pow(t, 1.5);
      response.depth_m.push_back(depth);
      response.force_n.push_back(k * std::pow(depth, 1.5));
    }
  }
  database.tools = {
      make_table(ToolShape{"ball", "sphere", 0.005, 0.3, 0.0005}, responses)};
  database.provenance.writer = "generated";
  return database;
}

}  // namespace palpate
