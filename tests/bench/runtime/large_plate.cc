#include "tests/bench/runtime/large_plate.h"

#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kHalfGapMetres = 0.5;
constexpr double kDepthMetres = 0.005;

void add_plate(SurfaceMesh& mesh, std::int64_t side, double step_m, double x_m,
               std::int64_t plate) {
  const std::int64_t node = plate * side * side;
  Eigen::Index t = plate * 2 * (side - 1) * (side - 1);
  for (std::int64_t j = 0; j < side; ++j) {
    for (std::int64_t i = 0; i < side; ++i) {
      const auto v = static_cast<std::int32_t>(node + j * side + i);
      mesh.position_m.row(v) << x_m + step_m * static_cast<double>(i),
          step_m * static_cast<double>(j), 0.0;
      if (i + 1 < side && j + 1 < side) {
        const auto up = static_cast<std::int32_t>(v + side);
        mesh.triangle.row(t++) << v, v + 1, up + 1;
        mesh.triangle.row(t++) << v, up + 1, up;
      }
    }
  }
}

NodeResponse response(const Eigen::Vector3d& p, int samples) {
  NodeResponse response;
  response.direction = Eigen::Vector3d::UnitZ();
  response.origin = ResponseOrigin::kSimulated;
  response.error_relative = 0.01;
  const double k = 2000.0 * (1.5 + std::sin(7.0 * p.x()) * std::cos(5.0 * p.y()));
  for (int j = 0; j < samples; ++j) {
    const double depth_m = kDepthMetres * j / (samples - 1);
    response.depth_m.push_back(depth_m);
    response.force_n.push_back(k * std::pow(depth_m, 1.5));
  }
  return response;
}

}  // namespace

std::int64_t plate_side(std::int64_t nodes) {
  return static_cast<std::int64_t>(std::sqrt(static_cast<double>(nodes) / 2.0));
}

ResponseDatabase stream_body(std::int64_t nodes, int samples) {
  if (nodes < 8 || nodes > 100'000'000) {
    throw InputError(fmt::format("{} nodes, must be 8 to 100000000", nodes));
  }
  const std::int64_t side = plate_side(nodes);
  ResponseDatabase database;
  database.body.position_m.resize(2 * side * side, 3);
  database.body.triangle.resize(4 * (side - 1) * (side - 1), 3);
  const double fine_side_m = kFineTriangleM * static_cast<double>(side - 1);
  add_plate(database.body, side, kFineTriangleM, -kHalfGapMetres - fine_side_m, 0);
  add_plate(database.body, side, kCoarseTriangleM, kHalfGapMetres, 1);
  database.normal = Points::Zero(2 * side * side, 3);
  database.normal.col(2).setOnes();
  std::vector<NodeResponse> responses;
  responses.reserve(static_cast<std::size_t>(2 * side * side));
  for (Eigen::Index i = 0; i < database.body.position_m.rows(); ++i) {
    responses.push_back(response(database.body.position_m.row(i).transpose(), samples));
  }
  database.tools = {
      make_table(ToolShape{"ball", "sphere", 0.005, 0.3, 0.0005}, responses)};
  database.provenance.writer = kStreamBodyWriter;
  return database;
}

void write_stream_body(const std::filesystem::path& file, std::int64_t nodes,
                       int samples) {
  const pid_t child = fork();
  if (child == 0) {
    int status = 0;
    try {
      write_database(file, stream_body(nodes, samples));
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      status = 1;
    }
    _exit(status);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || status != 0) {
    throw InputError(
        fmt::format("{}: the body of {} nodes was not written", file.string(), nodes));
  }
}

}  // namespace palpate
