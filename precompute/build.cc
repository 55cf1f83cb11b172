#include "precompute/build.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>

#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "formats/error.h"
#include "formats/sha256.h"

namespace palpate {
namespace {

using SharedTool = std::shared_ptr<const ToolSurface>;

std::vector<SharedTool> tool_surfaces(const Scene& scene) {
  std::vector<SharedTool> tools;
  for (const ToolShape& tool : scene.tool) {
    tools.push_back(std::make_shared<const ToolSurface>(tool));
  }
  return tools;
}

IndentationPath path_of(const Scene& scene, const BodyModel& body,
                        const SharedTool& tool, std::int32_t vertex) {
  return {.vertex_m = body.surface.position_m.row(vertex).transpose(),
          .outward = body.normal.row(vertex).transpose(),
          .tool = tool,
          .depth_max_m = scene.reach.depth_max_m,
          .force_max_n = scene.reach.force_max_n,
          .samples = scene.accuracy.depths};
}

// What the tool may touch; nothing where its handle is in the way.
std::vector<std::int32_t> patch_of(const BodyModel& body, const IndentationPath& path,
                                   std::int32_t vertex) {
  const std::int32_t start =
      body.contact.of_mesh_node[static_cast<std::size_t>(vertex)];
  const double radius_m = patch_radius_m(path, body.node_spacing_m);
  return std::isfinite(radius_m)
             ? contact_patch(body.contact, body.supports, start, radius_m)
             : std::vector<std::int32_t>{};
}

double largest_patch_radius_m(const Scene& scene, const BodyModel& body,
                              std::span<const std::int32_t> vertices) {
  double radius = 0.0;
  for (const SharedTool& tool : tool_surfaces(scene)) {
    for (const std::int32_t vertex : vertices) {
      radius = std::fmax(radius, patch_radius_m(path_of(scene, body, tool, vertex),
                                                body.node_spacing_m));
    }
  }
  return radius;
}

// Contact nodes in the patches of the given vertices, ascending.
std::vector<std::int32_t> nodes_to_load(const Scene& scene, const BodyModel& body,
                                        std::span<const std::int32_t> vertices) {
  std::vector<char> wanted(body.contact.node.size(), 0);
  for (const SharedTool& tool : tool_surfaces(scene)) {
    for (const std::int32_t vertex : vertices) {
      const IndentationPath path = path_of(scene, body, tool, vertex);
      for (const std::int32_t v : patch_of(body, path, vertex)) {
        wanted[static_cast<std::size_t>(v)] = 1;
      }
    }
  }
  std::vector<std::int32_t> nodes;
  for (std::size_t v = 0; v < wanted.size(); ++v) {
    if (wanted[v] != 0) {
      nodes.push_back(static_cast<std::int32_t>(v));
    }
  }
  return nodes;
}

SurfaceCompliance compliance_of(
    const Scene& scene, const BodyModel& body, std::span<const std::int32_t> vertices,
    const std::function<void(std::size_t, std::size_t)>& told) {
  std::vector<std::int32_t> nodes = nodes_to_load(scene, body, vertices);
  const std::size_t columns = nodes.size();
  // Two nodes of one patch are at most twice its radius apart.
  return {*body.factor,
          body.supports,
          body.contact,
          std::move(nodes),
          2.0 * largest_patch_radius_m(scene, body, vertices),
          [&](std::size_t done) {
            told(done, columns);
          }};
}

std::vector<NodeResponse> press_all(const Scene& scene, const BodyModel& body,
                                    const SurfaceCompliance& compliance,
                                    const ToolShape& tool,
                                    std::span<const std::int32_t> vertices,
                                    Progress& progress) {
  std::vector<NodeResponse> responses(
      static_cast<std::size_t>(body.surface.position_m.rows()));
  const auto surface = std::make_shared<const ToolSurface>(tool);
  std::atomic<std::size_t> done = 0;
  std::mutex reporting;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, vertices.size()),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const IndentationPath path = path_of(scene, body, surface, vertices[i]);
          const Indentation indentation =
              indent(body.contact, compliance, patch_of(body, path, vertices[i]), path);
          responses[static_cast<std::size_t>(vertices[i])] =
              to_response(indentation, path, scene.force_relative);
          ++done;
          if (reporting.try_lock()) {
            const std::lock_guard lock(reporting, std::adopt_lock);
            progress.advance(done, vertices.size(), "nodes");
          }
        }
      });
  return responses;
}

void count(const std::vector<NodeResponse>& responses, std::size_t pressed,
           std::vector<double>& errors, BuildReport& report) {
  std::int64_t solved = 0;
  std::int64_t failed = 0;
  for (const NodeResponse& response : responses) {
    failed += (response.flags & kFailed) != 0 ? 1 : 0;
    if (response.origin == ResponseOrigin::kSimulated) {
      ++solved;
      errors.push_back(response.error_relative);
      report.over_budget += (response.flags & kErrorOverBudget) != 0 ? 1 : 0;
    }
  }
  report.solved += solved;
  report.failed += failed;
  report.untouched += static_cast<std::int64_t>(pressed) - solved - failed;
  report.outside_reach += static_cast<std::int64_t>(responses.size() - pressed);
}

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(
                                       share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::int64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{usage.ru_maxrss} * 1024;
}

}  // namespace

ResponseDatabase build_database(const Scene& scene, Progress& progress,
                                BuildReport& report) {
  const auto began = std::chrono::steady_clock::now();
  const BodyModel body = make_body_model(scene, progress);
  const std::vector<std::int32_t> vertices = reachable_vertices(scene, body);
  progress.stage("surface compliance");
  const SurfaceCompliance compliance =
      compliance_of(scene, body, vertices, [&](std::size_t done, std::size_t total) {
        progress.advance(done, total, "columns");
      });
  ResponseDatabase database;
  std::vector<double> errors;
  for (const ToolShape& tool : scene.tool) {
    progress.stage(fmt::format("indentation with \"{}\"", tool.name));
    const auto responses = press_all(scene, body, compliance, tool, vertices, progress);
    count(responses, vertices.size(), errors, report);
    database.tools.push_back(make_table(tool, responses));
  }
  progress.finish();
  if (report.solved == 0) {
    throw NumericalError(fmt::format(
        "none of the {} reachable vertices gave a response: the tool touched nothing "
        "within depth_max_m = {}",
        vertices.size(), scene.reach.depth_max_m));
  }
  report.nodes = body.surface.position_m.rows();
  report.tets = body.mesh.tet.rows();
  report.unknowns = body.supports.free;
  report.error_median = quantile(errors, 0.5);
  report.error_p95 = quantile(errors, 0.95);
  report.node_spacing_m = body.node_spacing_m;
  report.min_dihedral_deg = body.min_dihedral_deg;
  report.notes = body.notes;
  database.body = body.surface;
  database.normal = body.normal;
  database.provenance = {
      .writer = fmt::format("palpate-precompute {}", PALPATE_VERSION),
      .scene_toml = scene.text,
      .source_file = scene.mesh.filename().string(),
      .source_sha256 = sha256_of_file(scene.mesh),
      .left_out =
          fmt::format("{} nodes held or outside reach, {} failed, {} untouched; "
                      "depths beyond {} m and forces beyond {} N",
                      report.outside_reach, report.failed, report.untouched,
                      scene.reach.depth_max_m, scene.reach.force_max_n)};
  report.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  report.peak_memory_bytes = peak_memory_bytes();
  return database;
}

IndentedVertex indent_vertex(const Scene& scene, const BodyModel& body,
                             const ToolShape& tool, std::int64_t vertex) {
  if (vertex < 0 || vertex >= body.surface.position_m.rows()) {
    throw InputError(
        fmt::format("vertex {} does not exist: the body has vertices 0 to {}", vertex,
                    body.surface.position_m.rows() - 1));
  }
  const auto v = static_cast<std::int32_t>(vertex);
  if (body.supports.free_index[3 * static_cast<std::size_t>(v)] < 0) {
    throw InputError(
        fmt::format("vertex {} is held by a support: nothing yields there", v));
  }
  const auto surface = std::make_shared<const ToolSurface>(tool);
  IndentedVertex result{.path = path_of(scene, body, surface, v), .indentation = {}};
  const std::vector<std::int32_t> patch = patch_of(body, result.path, v);
  if (patch.empty()) {
    throw InputError(
        fmt::format("tool {:?} cannot be pressed on vertex {}: its handle would be in "
                    "the body",
                    tool.name, v));
  }
  const auto compliance =
      compliance_of(scene, body, std::span(&v, 1), [](std::size_t, std::size_t) {});
  result.indentation = indent(body.contact, compliance, patch, result.path);
  return result;
}

std::int64_t nearest_vertex(const SurfaceMesh& surface,
                            const Eigen::Vector3d& point_m) {
  Eigen::Index nearest = 0;
  (surface.position_m.rowwise() - point_m.transpose())
      .rowwise()
      .squaredNorm()
      .minCoeff(&nearest);
  return nearest;
}

}  // namespace palpate
