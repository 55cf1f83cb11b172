#include "tests/peers/true_forces.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "formats/mesh/surface_search.h"
#include "precompute/body/mesh_grading.h"
#include "precompute/contact/linear_indentation.h"
#include "precompute/press/node_press.h"
#include "precompute/press/nonlinear_press.h"
#include "precompute/press/own_mesh_press.h"

namespace palpate::peers {
namespace {

constexpr std::size_t kLinearGroup = 8;  // places that share a mesh

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

std::vector<TrueCurve> press_group(const Scene& scene, const BodySource& body,
                                   std::span<const PlacedDepth> places,
                                   const ContactFocus& focus) {
  const bool nonlinear = is_nonlinear(scene, body);
  const SharedTool& tool = body.tool.front();
  const BodyModel model =
      make_own_model(scene, body, corners_of(body, places), focus, nonlinear);
  std::vector<PressedNode> nodes;
  for (const PlacedDepth& place : places) {
    nodes.push_back(placed(scene, model, tool, place));
  }
  const SurfaceCompliance compliance = compliance_of(model, nodes, {}, nullptr);
  for (PressedNode& node : nodes) {
    press_linear(model, compliance, node);
  }
  if (nonlinear) {
    for (PressedNode& node : nodes) {
      probe_nonlinearity(model, node);
    }
    press_nonlinear(model, compliance, nodes,
                    {.nonlinear = true, .options = nonlinear_options(scene, tool)});
  }
  std::vector<TrueCurve> curves;
  for (const PressedNode& node : nodes) {
    curves.push_back(curve_of(node));
  }
  return curves;
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
  const ContactFocus focus = finer(contact_focus(scene, body), times_finer);
  const std::size_t size = is_nonlinear(scene, body) ? 1 : kLinearGroup;
  std::vector<TrueCurve> curves;
  for (std::size_t begin = 0; begin < places.size(); begin += size) {
    const auto group = places.subspan(begin, std::min(size, places.size() - begin));
    for (TrueCurve& curve : press_group(scene, body, group, focus)) {
      curves.push_back(std::move(curve));
    }
    fmt::print(stderr, "truth: {} of {} places\n", curves.size(), places.size());
  }
  return curves;
}

}  // namespace palpate::peers
