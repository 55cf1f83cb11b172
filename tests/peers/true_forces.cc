#include "tests/peers/true_forces.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "formats/mesh/surface_search.h"
#include "precompute/body/mesh_grading.h"
#include "precompute/body/meshed_body.h"
#include "precompute/contact/linear_indentation.h"
#include "precompute/press/node_press.h"
#include "precompute/press/nonlinear_press.h"
#include "precompute/press/own_mesh_press.h"
#include "precompute/process/parallel.h"

namespace palpate::peers {
namespace {

std::int32_t nearest_node(const ContactSurface& surface, const Eigen::Vector3d& at_m) {
  std::int32_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < surface.node.size(); ++i) {
    const double distance = (surface.node[i].position_m - at_m).squaredNorm();
    if (distance < least) {
      least = distance;
      nearest = static_cast<std::int32_t>(i);
    }
  }
  return nearest;
}

// Corners of the triangles that the places lie in.
std::vector<std::int32_t> corners_of(const BodySource& body,
                                     std::span<const PlacedDepth> places) {
  const SurfaceSearch search(body.surface);
  std::vector<std::int32_t> corners;
  for (const PlacedDepth& place : places) {
    const auto t = search.nearest(place.at_m).triangle;
    for (int k = 0; k < 3; ++k) {
      corners.push_back(body.surface.triangle(t, k));
    }
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

PressedNode placed(const Scene& scene, const BodyModel& model, const SharedTool& tool,
                   const PlacedDepth& place) {
  PressedNode node{.path = {.vertex_m = place.at_m,
                            .outward = place.outward,
                            .tool = tool,
                            .depth_max_m = place.depth_m,
                            .force_max_n = std::numeric_limits<double>::infinity(),
                            .samples = scene.accuracy.depths}};
  node.patch = contact_patch(model.contact, model.supports,
                             nearest_node(model.contact, place.at_m), place.outward,
                             patch_radius_m(node.path, model.contact_spacing_m));
  return node;
}

TrueCurve curve_of(const PressedNode& node) {
  TrueCurve curve{.depth_m = {}, .force_n = {}, .failure = node.failure};
  for (const IndentationSample& sample : node.indentation.sample) {
    curve.depth_m.push_back(sample.penetration_m);
    curve.force_n.push_back(sample.force_n);
  }
  if (curve.depth_m.size() < 2 && curve.failure.empty()) {
    curve.failure = "the tool meets nothing";
  }
  return curve;
}

std::vector<PressedNode> placed_all(const Scene& scene, const BodyModel& model,
                                    const SharedTool& tool,
                                    std::span<const PlacedDepth> places) {
  std::vector<PressedNode> nodes;
  for (const PlacedDepth& place : places) {
    nodes.push_back(placed(scene, model, tool, place));
  }
  return nodes;
}

// All places on one mesh, evenly fine where the tool comes.
std::vector<PressedNode> press_all_linear(const Scene& scene, const BodySource& body,
                                          std::span<const PlacedDepth> places,
                                          double times_finer) {
  const double spacing_m = uniform_spacing_m(scene, body, false) / times_finer;
  const UniformSurface fine = pressed_surface(body, corners_of(body, places), spacing_m,
                                              touched_radius_m(scene, body, spacing_m));
  const BodyModel model = make_body_model(scene, body, fine.surface);
  fmt::print(stderr, "truth: {} tets, contact nodes {:.2g} mm apart\n",
             model.mesh.tet.rows(), 1e3 * fine.node_spacing_m);
  std::vector<PressedNode> nodes = placed_all(scene, model, body.tool.front(), places);
  const SurfaceCompliance compliance = compliance_of(model, nodes, {}, nullptr);
  in_parallel(nodes.size(), [&](std::size_t i) {
    press_linear(model, compliance, nodes[i]);
  });
  return nodes;
}

// A place on a mesh of its own, graded to the contact.
PressedNode press_nonlinear_at(const Scene& scene, const BodySource& body,
                               const PlacedDepth& place, double times_finer) {
  const SharedTool& tool = body.tool.front();
  const BodyModel model =
      make_own_model(scene, body, corners_of(body, {&place, 1}),
                     finer(contact_focus(scene, body), times_finer), true);
  std::vector<PressedNode> nodes = placed_all(scene, model, tool, {&place, 1});
  const SurfaceCompliance compliance = compliance_among(model, nodes);
  press_linear(model, compliance, nodes.front());
  probe_nonlinearity(model, nodes.front());
  press_nonlinear(model, compliance, nodes,
                  {.nonlinear = true, .options = nonlinear_options(scene, tool)});
  return std::move(nodes.front());
}

}  // namespace

Eigen::Vector3d TrueCurve::at(double depth) const {
  const auto above = std::upper_bound(depth_m.begin(), depth_m.end(), depth);
  if (above == depth_m.begin()) {
    return Eigen::Vector3d::Zero();
  }
  const auto i =
      std::min(static_cast<std::size_t>(above - depth_m.begin()), depth_m.size() - 1);
  const double share = (depth - depth_m[i - 1]) / (depth_m[i] - depth_m[i - 1]);
  return force_n[i - 1] + share * (force_n[i] - force_n[i - 1]);
}

std::vector<TrueCurve> true_curves(const Scene& scene, const BodySource& body,
                                   std::span<const PlacedDepth> places,
                                   double times_finer) {
  std::vector<TrueCurve> curves;
  if (!is_nonlinear(scene, body)) {
    for (const PressedNode& node : press_all_linear(scene, body, places, times_finer)) {
      curves.push_back(curve_of(node));
    }
    return curves;
  }
  for (const PlacedDepth& place : places) {
    curves.push_back(curve_of(press_nonlinear_at(scene, body, place, times_finer)));
    fmt::print(stderr, "truth: {} of {} places\n", curves.size(), places.size());
  }
  return curves;
}

}  // namespace palpate::peers
