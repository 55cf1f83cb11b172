#include "runtime/bench/cylinder_body.h"

#include <cmath>
#include <numbers>

namespace palpate {
namespace {

constexpr double kBendM = 0.005;
constexpr double kDepthMaxM = 0.01;
constexpr int kSamples = 41;

// Rings along x, then the middle of either end.
SurfaceMesh cylinder(const CylinderBodyOptions& o) {
  SurfaceMesh mesh;
  const int rings = o.along + 1;
  mesh.position_m.resize(rings * o.around + 2, 3);
  for (int i = 0; i < rings; ++i) {
    const double x = o.length_m * (static_cast<double>(i) / o.along - 0.5);
    for (int j = 0; j < o.around; ++j) {
      // Half a step on every other ring: triangles of like sides.
      const double turn = (j + 0.5 * (i % 2)) / o.around;
      const double angle = 2.0 * std::numbers::pi * turn;
      mesh.position_m.row(i * o.around + j) << x, o.radius_m * std::cos(angle),
          o.radius_m * std::sin(angle);
    }
  }
  const int low = rings * o.around;
  mesh.position_m.row(low) << -0.5 * o.length_m, 0.0, 0.0;
  mesh.position_m.row(low + 1) << 0.5 * o.length_m, 0.0, 0.0;
  mesh.triangle.resize(2 * (o.along + 1) * o.around, 3);
  Eigen::Index t = 0;
  for (int j = 0; j < o.around; ++j) {
    const int next = (j + 1) % o.around;
    for (int i = 0; i < o.along; ++i) {
      const int a = i * o.around + j;
      const int b = i * o.around + next;
      const int c = a + o.around;
      const int d = b + o.around;
      if (i % 2 == 0) {
        mesh.triangle.row(t++) << a, b, c;
        mesh.triangle.row(t++) << b, d, c;
      } else {
        mesh.triangle.row(t++) << a, d, c;
        mesh.triangle.row(t++) << a, b, d;
      }
    }
    mesh.triangle.row(t++) << low, next, j;
    mesh.triangle.row(t++) << low + 1, o.along * o.around + j,
        o.along * o.around + next;
  }
  return mesh;
}

NodeResponse response(double stiffness_n_per_m, const Eigen::Vector3d& normal) {
  NodeResponse r;
  r.direction = normal;
  r.origin = ResponseOrigin::kSimulated;
  for (int i = 0; i < kSamples; ++i) {
    const double d = kDepthMaxM * i / (kSamples - 1);
    r.depth_m.push_back(d);
    r.force_n.push_back(cylinder_force_n(stiffness_n_per_m, d));
  }
  return r;
}

}  // namespace

double cylinder_force_n(double stiffness_n_per_m, double depth_m) {
  if (depth_m <= 0.0) {
    return 0.0;
  }
  return depth_m <= kBendM ? 100.0 * stiffness_n_per_m * depth_m * depth_m
                           : stiffness_n_per_m * (depth_m - 0.5 * kBendM);
}

ResponseDatabase cylinder_body(const CylinderBodyOptions& options) {
  ResponseDatabase database;
  database.body = cylinder(options);
  database.normal = vertex_normals(database.body);
  const Eigen::Index nodes = database.body.position_m.rows();
  std::vector<NodeResponse> responses(static_cast<std::size_t>(nodes));
  for (Eigen::Index i = 0; i < nodes; ++i) {
    const double x = database.body.position_m(i, 0);
    // |x| = length / 2 on the rings at the ends and on the ends' middles.
    const bool side = std::abs(x) < 0.499 * options.length_m;
    if (side) {
      responses[static_cast<std::size_t>(i)] =
          response(options.stiffness_n_per_m, database.normal.row(i).transpose());
    }
  }
  ToolShape tool;
  tool.name = "ball";
  tool.kind = "sphere";
  tool.radius_m = options.tool_radius_m;
  tool.friction = options.friction;
  tool.presliding_m = options.presliding_m;
  database.tools.push_back(make_table(tool, responses));
  database.provenance.writer = "palpate " PALPATE_VERSION;
  database.provenance.source_file = "the paper's cylinder, responses (31)";
  database.provenance.left_out = "the ends of the cylinder";
  return database;
}

}  // namespace palpate
