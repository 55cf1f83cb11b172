// What cutting a part out of a body costs in force, and that its work does not grow
// with the body.
//
// cut_out_study error | scale
//
// error: bodies from large to thin, pressed by a ball to a contact of radius a at their
// first vertex. The force of the part, cut at a distance R, over that of the whole body
// on the same tets, at the largest depth: with the cut clamped, with a coarse body of
// edges R/2 and of edges R behind it, and what the solver itself estimates.
// "order" is that of the error in a/R since the row before.
//
// scale: a slab of equal triangles, 1, 4 and 16 times larger, cut at the same distance:
// seconds and memory of the mesh and the coarse body (once), of a node, and of the
// whole body's factor where it is small enough.
#include <cmath>
#include <cstdlib>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "formats/base/stopwatch.h"
#include "precompute/press/cut_out_press.h"
#include "precompute/process/peak_memory.h"
#include "precompute/surface/primitive_bodies.h"
#include "precompute/surface/refine_surface.h"
#include "tests/support/study_bodies.h"
#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

constexpr double kContact_m = 1e-3;  // a
constexpr double kRadius_m = 10e-3;  // of the ball

struct Body {
  std::string name;
  SurfaceMesh surface;
  SceneSupport support;
  double poissons_ratio = 0.45;
};

SceneSupport held(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return {.box_m = Eigen::AlignedBox3d(low, high),
          .plane = {},
          .patch = {},
          .stiffness_pa_per_m = 0.0};
}

Scene scene_of(const Body& body) {
  Scene scene;
  scene.material.resize(1);
  scene.material[0].youngs_modulus_pa = 10e3;
  scene.material[0].poissons_ratio = body.poissons_ratio;
  scene.support = {body.support};
  scene.tool = {sphere(kRadius_m)};
  scene.reach.depth_max_m = kContact_m * kContact_m / kRadius_m;
  scene.accuracy.depths = 4;
  return scene;
}

BodySource source_of(const Body& body, const Scene& scene) {
  BodySource source;
  source.surface = body.surface;
  source.normal = vertex_normals(body.surface);
  source.material = {
      linear(scene.material[0].youngs_modulus_pa, scene.material[0].poissons_ratio)};
  source.tool = {std::make_shared<const ToolSurface>(scene.tool[0])};
  return source;
}

double force_n(const PressedNode& node) {
  if (!node.failure.empty() || node.indentation.sample.size() < 2) {
    throw std::runtime_error("no press: " + node.failure);
  }
  return node.indentation.sample.back().force_n.norm();
}

constexpr double kFinest = 0.25;  // edges, in contact radii
constexpr double kGrowth = 0.5;   // edges over the distance from the contact

SurfaceMesh refined(const SurfaceMesh& surface, const Eigen::Vector3d& at) {
  return refine_longest_edge(
      surface,
      [&](const Eigen::Vector3d& p) {
        return std::max(kFinest * kContact_m, kGrowth * ((p - at).norm() - kContact_m));
      },
      200000);
}

double cut_force_n(Scene scene, const BodySource& source, const SurfaceMesh& surface,
                   const SceneCutout& cutout, double* estimate = nullptr) {
  scene.cutout = cutout;
  const std::int32_t vertex = 0;
  const CutOutSolver solver(scene, source, surface, 0.5 * kFinest * kContact_m,
                            std::span(&vertex, 1));
  const PressedNode node = solver.press(source.tool[0], std::span(&vertex, 1)).front();
  if (estimate != nullptr) {
    *estimate = node.indentation.exterior_error_relative;
  }
  return force_n(node);
}

void study_error(const Body& body) {
  const Scene scene = scene_of(body);
  const BodySource source = source_of(body, scene);
  const SurfaceMesh surface =
      refined(body.surface, body.surface.position_m.row(0).transpose());
  BodyModel whole = make_body_model(scene, source, surface);
  whole.contact_spacing_m = 0.5 * kFinest * kContact_m;
  const std::int32_t vertex = 0;
  const double whole_n = force_n(
      press_on_model(scene, source, whole, source.tool[0], std::span(&vertex, 1), {})
          .front());
  fmt::print("{}: {} tets, {:.4g} N\n{:>5} {:>16} {:>16} {:>16} {:>14}\n", body.name,
             whole.mesh.tet.rows(), whole_n, "R/a", "clamped", "coarse, R/2",
             "coarse, R", "estimate, R/2");
  std::vector<double> before;
  double before_radius = 0.0;
  for (const double radius : {4.0, 6.0, 9.0, 13.0}) {
    const double radius_m = radius * kContact_m;
    double estimate = 0.0;
    const std::vector<double> error{
        cut_force_n(scene, source, surface, {radius_m, "clamped", 0.0}) / whole_n - 1.0,
        cut_force_n(scene, source, surface, {radius_m, "coarse", 0.5 * radius_m},
                    &estimate) /
                whole_n -
            1.0,
        cut_force_n(scene, source, surface, {radius_m, "coarse", radius_m}) / whole_n -
            1.0};
    fmt::print("{:5.0f}", radius);
    for (std::size_t i = 0; i < error.size(); ++i) {
      const std::string order =
          before.empty()
              ? ""
              : fmt::format("({:.1f})", -std::log(std::abs(error[i] / before[i])) /
                                            std::log(radius / before_radius));
      fmt::print(" {:8.3f} % {:>6}", 100.0 * error[i], order);
    }
    fmt::print(" {:12.3f} %\n", 100.0 * estimate);
    std::fflush(stdout);
    before = error;
    before_radius = radius;
  }
}

Body slab(const std::string& name, double half_width, double depth) {
  return {name,
          graded_block(half_width * kContact_m, depth * kContact_m,
                       0.5 * half_width * kContact_m, 4),
          held({-1, -1, -1}, {1, 1, -depth * kContact_m * (1.0 - 1e-9)})};
}

// Held along one side alone: it bends.
Body plate(double half_width, double depth) {
  Body body = slab("plate held at one side, 32 a wide, 4 a thick", half_width, depth);
  body.support = {
      .box_m = {},
      .plane = ScenePlane{Eigen::Vector3d(-half_width * kContact_m * (1 - 1e-9), 0, 0),
                          Eigen::Vector3d::UnitX()},
      .patch = {},
      .stiffness_pa_per_m = 0.0};
  return body;
}

void study_errors() {
  study_error(slab("block, 96 a wide, 48 a deep", 48.0, 48.0));
  Body ball{"ball of 12 a, held below", icosphere(12.0 * kContact_m, 2),
            held({-1, -1, -1}, {1, 1, -6.0 * kContact_m})};
  // The first vertex to the top.
  const Eigen::Vector3d first = ball.surface.position_m.row(0).transpose();
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(first, Eigen::Vector3d::UnitZ());
  ball.surface.position_m =
      (ball.surface.position_m * turn.toRotationMatrix().transpose()).eval();
  study_error(ball);
  study_error(slab("layer on a table, 96 a wide, 4 a thick", 48.0, 4.0));
  study_error(plate(16.0, 4.0));
}

constexpr double kEdge = 0.5;  // of the slabs, over contact radii

// Meshes, factorises and presses all of the body.
void print_whole(const Body& body, const Scene& scene, const BodySource& source) {
  const std::int32_t vertex = 0;
  restart_peak_memory();
  std::optional<BodyModel> whole;
  const double whole_s = seconds_of([&] {
    whole.emplace(make_body_model(scene, source, body.surface));
  });
  whole->contact_spacing_m = 0.5 * kEdge * kContact_m;
  double f = 0.0;
  const double press_s = seconds_of([&] {
    f = force_n(
        press_on_model(scene, source, *whole, source.tool[0], std::span(&vertex, 1), {})
            .front());
  });
  fmt::print("{:>9} {:>9} {:>8} {:9.1f} {:9.2f} {:>9} {:10.2f} {:>10} {:10.6f}\n",
             "whole", "", "", whole_s, 1e-9 * static_cast<double>(peak_memory_bytes()),
             "", press_s, "", f);
  std::fflush(stdout);
}

void study_scale() {
  constexpr double kCut = 10.0;      // R over contact radii
  constexpr double kDepth = 6.0;     // of the slab, in contact radii
  constexpr int kCells = 64;         // of the smallest slab
  constexpr int kMostWhole = 40000;  // triangles
  fmt::print("{:>9} {:>9} {:>8} {:>9} {:>9} {:>9} {:>10} {:>10} {:>10}\n", "triangles",
             "tets", "coarse", "once s", "once GB", "part tets", "node s", "node GB",
             "force N");
  for (const int times : {1, 2, 4}) {
    const double half_width_m = 0.5 * times * kCells * kEdge * kContact_m;
    Body body{
        "slab",
        graded_block(half_width_m, kDepth * kContact_m,
                     half_width_m * (1.0 - 1.0 / (times * kCells)), times * kCells),
        held({-1, -1, -1}, {1, 1, -kDepth * kContact_m * (1.0 - 1e-9)})};
    Scene scene = scene_of(body);
    scene.cutout = SceneCutout{kCut * kContact_m, "coarse", 0.5 * kCut * kContact_m};
    const BodySource source = source_of(body, scene);
    const std::int32_t vertex = 0;
    restart_peak_memory();
    std::optional<CutOutSolver> solver;
    const double once_s = seconds_of([&] {
      solver.emplace(scene, source, body.surface, 0.5 * kEdge * kContact_m,
                     std::span(&vertex, 1));
    });
    const auto once_bytes = static_cast<double>(peak_memory_bytes());
    restart_peak_memory();
    const auto base_bytes = static_cast<double>(peak_memory_bytes());
    double f = 0.0;
    const double node_s = seconds_of([&] {
      f = force_n(solver->press(source.tool[0], std::span(&vertex, 1)).front());
    });
    const double node_bytes = static_cast<double>(peak_memory_bytes()) - base_bytes;
    fmt::print(
        "{:9} {:9} {:8} {:9.1f} {:9.2f} {:9} {:10.2f} {:10.3f} {:10.6f}\n",
        body.surface.triangle.rows(), solver->tets().tet.rows(),
        solver->coarse()->model().mesh.tet.rows(), once_s, 1e-9 * once_bytes,
        solver->part(std::span(&vertex, 1), kCut * kContact_m).model.mesh.tet.rows(),
        node_s, 1e-9 * node_bytes, f);
    std::fflush(stdout);
    solver.reset();
    if (body.surface.triangle.rows() > kMostWhole) {
      continue;
    }
    print_whole(body, scene, source);
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  const std::string which = argc == 2 ? argv[1] : "";
  try {
    if (which == "error") {
      palpate::study_errors();
    } else if (which == "scale") {
      palpate::study_scale();
    } else {
      fmt::print(stderr, "usage: cut_out_study error | scale\n");
      return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    fmt::print(stderr, "cut_out_study: {}\n", error.what());
    return EXIT_FAILURE;
  }
}
