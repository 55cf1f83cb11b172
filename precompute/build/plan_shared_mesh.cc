#include "precompute/build/plan_shared_mesh.h"

#include <algorithm>
#include <cmath>

#include "formats/base/stopwatch.h"
#include "formats/database/error_calibration.h"
#include "precompute/build/estimated_share.h"
#include "precompute/contact/indentation_response.h"
#include "precompute/press/compliance_sample.h"
#include "precompute/press/nonlinear_press.h"
#include "precompute/press/press_cost.h"
#include "precompute/process/machine_memory.h"
#include "precompute/process/parallel.h"

namespace palpate {
namespace {

constexpr std::size_t kPressesPerWorker = 3;
// What would take longer is extrapolated from something smaller, so that a plan takes
// seconds.
constexpr double kFactorCpuS = 1.5;
constexpr double kColumnsCpuS = 2.0;

}  // namespace

PlanSharedMesh::PlanSharedMesh(const Scene& scene, const BodySource& body,
                               const PressStrategy& strategy,
                               std::span<const std::int32_t> vertices,
                               std::size_t workers, Progress& progress,
                               PlanReport& report)
    : scene_(scene),
      body_(body),
      strategy_(strategy),
      vertex_(vertices),
      workers_(workers),
      progress_(progress),
      report_(report) {
  const SurfaceMesh surface = affordable_surface();
  make_mesh(surface);
  const std::vector<PressedNode> placed = place_tools();
  double columns = static_cast<double>(column_sample(*model_, placed, {}).all);
  if (times_larger_ > 1.0) {
    columns *= near(strategy_.surface) / std::max(near(surface), 1.0);
  }
  time_columns(placed, static_cast<std::size_t>(std::lround(columns)));
}

// The shared surface, or one so much coarser that its factor is made in seconds.
SurfaceMesh PlanSharedMesh::affordable_surface() const {
  const auto seconds = [](const SurfaceMesh& surface) {
    return expected_cpu_s({static_cast<double>(surface.triangle.rows()), 0.0});
  };
  SurfaceMesh surface = strategy_.surface;
  const double reach_m = touched_radius_m(scene_, body_, strategy_.spacing_m);
  for (double spacing_m = strategy_.spacing_m; seconds(surface) > kFactorCpuS;) {
    spacing_m *= 1.5;
    const Eigen::Index before = surface.triangle.rows();
    surface = pressed_surface(body_, vertex_, spacing_m, reach_m).surface;
    if (surface.triangle.rows() == before ||
        surface.triangle.rows() == body_.surface.triangle.rows()) {
      break;
    }
  }
  return surface;
}

// Contact nodes that the tools may touch.
double PlanSharedMesh::near(const SurfaceMesh& surface) const {
  return static_cast<double>(contact_nodes_near(
      surface, body_, vertex_, touched_radius_m(scene_, body_, strategy_.spacing_m)));
}

void PlanSharedMesh::make_mesh(const SurfaceMesh& surface) {
  const std::string work = "shared mesh and factor";
  progress_.stage(work);
  times_larger_ = static_cast<double>(strategy_.surface.triangle.rows()) /
                  static_cast<double>(surface.triangle.rows());
  const double seconds = seconds_of([&] {
    model_.emplace(make_body_model(scene_, body_, surface));
  });
  model_->contact_spacing_m = strategy_.spacing_m * std::sqrt(times_larger_);
  report_.cost.push_back(
      cost_once(work, seconds,
                expected_cpu_s({times_larger_, 0.0}) / expected_cpu_s({1.0, 0.0})));
  report_.tets = static_cast<std::int64_t>(
      times_larger_ * static_cast<double>(model_->mesh.tet.rows()));
  report_.unknowns = static_cast<std::int64_t>(
      times_larger_ * static_cast<double>(model_->supports.free));
  if (times_larger_ > 1.0) {
    require_memory(strategy_.surface.triangle.rows());
    report_.peak_memory_bytes = static_cast<std::int64_t>(
        expected_memory_bytes(strategy_.surface.triangle.rows()));
  }
}

std::vector<PressedNode> PlanSharedMesh::place_tools() {
  std::vector<PressedNode> placed;
  const double seconds = seconds_of([&] {
    for (const SharedTool& tool : body_.tool) {
      for (const std::int32_t v : vertex_) {
        placed.push_back(placed_node(scene_, body_, *model_, tool, v));
      }
    }
  });
  report_.cost.push_back(cost_once("place the tools", seconds));
  return placed;
}

void PlanSharedMesh::time_columns(std::span<const PressedNode> placed,
                                  std::size_t columns) {
  progress_.stage("a few columns");
  report_.columns = static_cast<std::int64_t>(columns);
  const double triangles =
      static_cast<double>(strategy_.surface.triangle.rows()) / times_larger_;
  // As many vertices' columns as take seconds, one vertex's at least.
  ColumnSample sample;
  for (std::size_t count = kPressesPerWorker * workers_; count > 0; --count) {
    sample_ = spread_over(vertex_, count);
    sample = column_sample(*model_, placed, sample_);
    if (expected_cpu_s({triangles, static_cast<double>(sample.solved)}) <
        kColumnsCpuS) {
      break;
    }
  }
  if (sample.solved == 0) {
    return;
  }
  const double none = seconds_of([&] {
    (void)compliance_of(*model_, placed, std::vector<char>(sample.wanted.size(), 0),
                        nullptr);
  });
  const double some = seconds_of([&] {
    compliance_.emplace(compliance_of(*model_, placed, sample.wanted,
                                      [&](std::size_t done, std::size_t total) {
                                        progress_.advance(done, total, "columns");
                                      }));
  });
  if (times_larger_ > 1.0) {  // more nodes, and as many more near each
    report_.peak_memory_bytes +=
        static_cast<std::int64_t>(times_larger_ * times_larger_ * compliance_->bytes());
  }
  report_.cost.push_back(cost_once("find pairs of near contact nodes", none));
  report_.cost.push_back(
      cost_of_all("columns of the surface compliance", columns, sample.solved,
                  std::max(some - none, 0.0),
                  expected_column_cpu_s(times_larger_) / expected_column_cpu_s(1.0)));
  time_linear();
}

void PlanSharedMesh::time_linear() {
  progress_.stage("a few linear presses");
  std::vector<double> error(sample_.size(), 0.0);
  const double seconds = seconds_of([&] {
    in_parallel(sample_.size(), [&](std::size_t i) {
      PressedNode node =
          placed_node(scene_, body_, *model_, body_.tool.front(), sample_[i]);
      press_linear(*model_, *compliance_, node);
      if (node.indentation.sample.size() > 1) {
        error[i] = to_response(node.indentation, node.path, scene_.force_relative)
                       .error_relative;
      }
    });
  });
  report_.cost.push_back(cost_of_all(
      "linear presses", vertex_.size() * body_.tool.size(), sample_.size(), seconds));
  outside_ = share_above(error, scene_.force_relative / kLeastErrorFactor);
}

void PlanSharedMesh::time_nonlinear(std::size_t count) {
  if (!compliance_) {
    return;  // no tool touches anything
  }
  progress_.stage("a few nonlinear presses");
  const SharedTool& tool = body_.tool.front();
  const double seconds = seconds_of([&] {
    in_parallel(workers_, [&](std::size_t w) {
      std::vector<PressedNode> nodes;
      if (w < sample_.size()) {
        nodes.push_back(placed_node(scene_, body_, *model_, tool, sample_[w]));
        press_linear(*model_, *compliance_, nodes.back());
      }
      press_nonlinear(*model_, *compliance_, nodes,
                      {.nonlinear = true, .options = nonlinear_options(scene_, tool)});
    });
  });
  report_.cost.push_back(cost_of_all(
      "nonlinear presses", count, std::min(sample_.size(), workers_), seconds,
      expected_column_cpu_s(times_larger_) / expected_column_cpu_s(1.0)));
}

}  // namespace palpate
