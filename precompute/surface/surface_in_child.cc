#include "precompute/surface/surface_in_child.h"

#include <cstddef>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/process/packed_bytes.h"
#include "precompute/process/run_in_child.h"

namespace palpate {
namespace {

// The first of the message: how long the mesh is. `failure` bytes stand for all else.
struct Sizes {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::size_t failure = 0;
  double lost_share = 0.0;
};

std::vector<char> packed(const SurfaceAndCounts& result) {
  const Sizes sizes{.vertices = static_cast<std::size_t>(result.mesh.position_m.rows()),
                    .triangles = static_cast<std::size_t>(result.mesh.triangle.rows()),
                    .lost_share = result.lost_share};
  std::vector<char> bytes;
  append_bytes(bytes, &sizes, 1);
  append_bytes(bytes, result.mesh.position_m.data(), 3 * sizes.vertices);
  append_bytes(bytes, result.mesh.triangle.data(), 3 * sizes.triangles);
  append_bytes(bytes, result.count);
  return bytes;
}

// The first line, for libraries write several.
std::vector<char> packed_failure(const std::string& text) {
  const std::string line = text.substr(0, text.find('\n'));
  const Sizes sizes{.failure = line.size()};
  std::vector<char> bytes;
  append_bytes(bytes, &sizes, 1);
  append_bytes(bytes, line.data(), sizes.failure);
  return bytes;
}

SurfaceAndCounts unpacked(std::span<const char> bytes, std::string_view what) {
  Sizes sizes;
  take_bytes(bytes, &sizes, 1);
  if (sizes.failure > 0) {
    std::string text(sizes.failure, ' ');
    take_bytes(bytes, text.data(), sizes.failure);
    throw NumericalError(fmt::format("{}: {}", what, text));
  }
  SurfaceAndCounts result;
  result.lost_share = sizes.lost_share;
  result.mesh.position_m.resize(static_cast<Eigen::Index>(sizes.vertices), 3);
  result.mesh.triangle.resize(static_cast<Eigen::Index>(sizes.triangles), 3);
  take_bytes(bytes, result.mesh.position_m.data(), 3 * sizes.vertices);
  take_bytes(bytes, result.mesh.triangle.data(), 3 * sizes.triangles);
  take_bytes(bytes, result.count);
  return result;
}

// What goes before the mesh.
struct Job {
  SurfaceWork work = nullptr;
  double parameter = 0.0;
};

std::vector<char> do_job(std::span<const char> input) {
  try {
    Job job;
    take_bytes(input, &job, 1);
    return packed(job.work(unpacked(input, "input").mesh, job.parameter));
  } catch (const std::exception& error) {
    return packed_failure(error.what());
  }
}

}  // namespace

SurfaceAndCounts surface_in_child(std::string_view what, SurfaceWork work,
                                  const SurfaceMesh& mesh, double parameter) {
  const Job job{.work = work, .parameter = parameter};
  std::vector<char> input;
  append_bytes(input, &job, 1);
  const std::vector<char> packed_mesh = packed({.mesh = mesh, .count = {}});
  input.insert(input.end(), packed_mesh.begin(), packed_mesh.end());
  const ChildResult child = run_in_child(do_job, input, {});
  if (!child.done) {
    throw NumericalError(fmt::format("{}: it failed: {}", what, child.failure));
  }
  SurfaceAndCounts result = unpacked(child.bytes, what);
  const SurfaceMesh& made = result.mesh;
  if (made.triangle.rows() == 0 || !made.position_m.allFinite() ||
      made.triangle.minCoeff() < 0 ||
      made.triangle.maxCoeff() >= made.position_m.rows()) {
    throw NumericalError(fmt::format("{}: nothing sensible came out of it", what));
  }
  return result;
}

}  // namespace palpate
