#include "tests/support/small_database.h"

#include <cmath>
#include <limits>

namespace palpate {
namespace {

NodeResponse hertz_response(const Eigen::Vector3d& direction, double k, int samples) {
  NodeResponse response;
  response.direction = direction;
  response.direction_spread_rad = 0.01;
  response.touch_offset_m = -1e-5 * samples;
  response.error_relative = 0.02;
  response.origin = ResponseOrigin::kSimulated;
  for (int i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) / (samples - 1);
    const double d = 0.005 * t * t;
    response.depth_m.push_back(d);
    response.force_n.push_back(k * std::pow(d, 1.5));
  }
  return response;
}

}  // namespace

SurfaceMesh octahedron(double radius_m) {
  SurfaceMesh mesh;
  mesh.position_m.resize(6, 3);
  mesh.position_m << 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1;
  mesh.position_m *= radius_m;
  mesh.triangle.resize(8, 3);
  mesh.triangle << 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3,
      5;
  return mesh;
}

ResponseDatabase small_database() {
  ResponseDatabase database;
  database.body = octahedron(0.05);
  database.normal = vertex_normals(database.body);
  std::vector<NodeResponse> responses;
  for (int i = 0; i < 6; ++i) {
    responses.push_back(
        hertz_response(database.normal.row(i).transpose(), 1000.0 * (1 + i), 4 + i));
  }
  responses[4].force_n.back() *= 0.5;
  responses[5] = {};
  const ToolShape ball{"ball", "sphere", 0.005, 0.3, 0.0005};
  const ToolShape tip{"tip", "sphere", 0.002, 0.0, 0.0};
  // Not in alphabetical order, so that the order itself is tested.
  database.tools = {make_table(tip, responses), make_table(ball, responses)};
  database.provenance = {"palpate-test 1",        "[body]\nmesh = \"octahedron.obj\"\n",
                         "octahedron.obj",        std::string(64, 'a'),
                         "node 5: not reachable", std::string(64, 'c')};
  return database;
}

ResponseRelaxation relaxing() {
  return {.rule = "median of the probes, the same at every node",
          .probes = 3,
          .speed_m_per_s = 1e-3,
          .seconds = 10.0,
          .terms = {{0.26}, {0.3}, {0.42}, {4.5}}};
}

Viscoelasticity viscous() {
  Viscoelasticity relaxation;
  relaxation.rule = "made up";
  relaxation.probes = 7;
  relaxation.speed_m_per_s = 1e-3;
  relaxation.tau_s = {0.5, 4.0};
  relaxation.g.resize(6, 2);
  for (int i = 0; i < 6; ++i) {
    relaxation.g.row(i) << 0.05F * static_cast<float>(i), 0.3F;
  }
  relaxation.error_relative = {0.01F, 0.01F, 0.02F, 0.03F, 0.01F, 0.0F};
  relaxation.bundle_depth_m = {0.001, 0.002};
  relaxation.sites.spacing_m = 0.006;
  relaxation.sites.node = {4, 0, 2};
  relaxation.sites.site.setConstant(6, kMostNodeSites, -1);
  relaxation.sites.weight.setZero(6, kMostNodeSites);
  relaxation.sites.site.leftCols<2>() << 1, -1, 0, 1, 2, -1, 2, 0, 0, -1, -1, -1;
  relaxation.sites.weight.leftCols<2>() << 1.0F, 0.0F, 0.25F, 0.75F, 1.0F, 0.0F, 0.5F,
      0.5F, 1.0F, 0.0F, 0.0F, 0.0F;
  return relaxation;
}

Measurement held() {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  Measurement measurement{{0.0, 1e-3, 0.0, 1e-3}, {0.0, 1.0, 0.0, 2.0}};
  measurement.run_begin = {0, 2, 4};
  measurement.relaxation = {
      .terms = {{0.2, kUnknown}, {0.3, kUnknown}, {0.4, kUnknown}, {5.0, kUnknown}},
      .speed_m_per_s = {1e-3, kUnknown},
      .seconds = {10.0, kUnknown},
      .rms_relative = {0.003, kUnknown}};
  return measurement;
}

}  // namespace palpate
