#include "precompute/press/cut_out_press.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/body/mesh_grading.h"

namespace palpate {
namespace {

// Neighbours that share a part lie in a disc of this share of its radius: a wider part
// costs more than it saves.
constexpr double kGroupShare = 0.5;
constexpr double kMostOnPart = 64.0;

// Tets of the part and its nodes on the cut, all of them.
QuadraticMesh with_cut(const CutOut& part, std::vector<std::int32_t>& cut) {
  Triangles faces(part.surface.rows() + part.cut.rows(), 3);
  faces << part.surface, part.cut;
  QuadraticMesh mesh = make_quadratic(part.tets, faces);
  const QuadraticTriangles cut_faces = mesh.surface.bottomRows(part.cut.rows());
  cut.assign(cut_faces.data(), cut_faces.data() + cut_faces.size());
  std::sort(cut.begin(), cut.end());
  cut.erase(std::unique(cut.begin(), cut.end()), cut.end());
  mesh.surface.conservativeResize(part.surface.rows(), 6);
  return mesh;
}

// Holds further nodes in all directions.
void hold(std::span<const std::int32_t> nodes, Supports& supports) {
  for (const std::int32_t node : nodes) {
    std::fill_n(supports.free_index.begin() + 3 * std::ptrdiff_t{node}, 3, -1);
  }
  supports.free = 0;
  for (std::int64_t& index : supports.free_index) {
    index = index < 0 ? -1 : supports.free++;
  }
}

}  // namespace

std::string cut_out_text(const Scene& scene) {
  if (!scene.cutout) {
    return {};
  }
  const SceneCutout& cutout = *scene.cutout;
  return fmt::format(
      "the body farther than {} m from a node, {}", cutout.radius_m,
      cutout.exterior == "coarse"
          ? fmt::format("in whose place stands a coarse body with edges of {} m",
                        cutout.coarse_edge_m)
          : "where it is clamped");
}

CutOutSolver::CutOutSolver(const Scene& scene, const BodySource& body,
                           const SurfaceMesh& surface, double spacing_m,
                           std::span<const std::int32_t> vertices)
    : scene_(scene),
      body_(body),
      tets_(connect(filled_body(body, surface).tets)),
      contact_spacing_m_(spacing_m) {
  for (const SharedTool& tool : body.tool) {
    const IndentationPath path{.vertex_m = Eigen::Vector3d::Zero(),
                               .outward = Eigen::Vector3d::UnitZ(),
                               .tool = tool,
                               .depth_max_m = scene.reach.depth_max_m};
    // The narrowest cut is the one of estimate(), kCutStep times narrower than asked
    // for. It must hold the candidate contact set and two node spacings around.
    const double least_m = kCutStep * (patch_radius_m(path, contact_spacing_m_) +
                                       2.0 * contact_spacing_m_);
    if (scene.cutout->radius_m < least_m) {
      throw InputError(fmt::format(
          "[cutout] radius_m is {} m, must be at least {:.3g} m: {} times what tool "
          "\"{}\" may touch when it is pressed {} m deep",
          scene.cutout->radius_m, least_m, kCutStep, tool->shape().name,
          scene.reach.depth_max_m));
    }
  }
  if (scene.cutout->exterior == "coarse") {
    const double edge_m = scene.cutout->coarse_edge_m;
    coarse_ = std::make_unique<const CoarseBody>(scene, body, vertices, edge_m);
    coarser_ =
        std::make_unique<const CoarseBody>(scene, body, vertices, kCutStep * edge_m);
  }
}

std::vector<std::vector<std::int32_t>> CutOutSolver::groups(
    std::span<const std::int32_t> vertices) const {
  const double share_m = kGroupShare * scene_.cutout->radius_m;
  // Vertices in a disc of radius share_m at the body's mean density of vertices.
  const double in_disc = std::numbers::pi * share_m * share_m *
                         static_cast<double>(body_.surface.position_m.rows()) /
                         surface_area_m2(body_.surface);
  return in_neighbourhoods(
      body_.surface, vertices,
      static_cast<std::size_t>(std::clamp(in_disc, 1.0, kMostOnPart)));
}

ClampedPart CutOutSolver::part(std::span<const std::int32_t> group,
                               double radius_m) const {
  const CutOut taken = cut_out(tets_, group, radius_m);
  ClampedPart part;
  BodyModel& model = part.model;
  std::vector<std::int32_t> cut;
  model.mesh = with_cut(taken, cut);
  model.material = body_.material;
  part.corner = taken.corner;
  for (const std::int32_t vertex : group) {
    model.corner.emplace(
        vertex, static_cast<std::int32_t>(
                    std::lower_bound(taken.corner.begin(), taken.corner.end(), vertex) -
                    taken.corner.begin()));
  }
  model.supports = scene_supports(scene_, model.mesh);
  // Where the scene holds the cut, the cut does not move.
  std::copy_if(
      cut.begin(), cut.end(), std::back_inserter(part.cut), [&](std::int32_t node) {
        return model.supports.free_index[3 * static_cast<std::size_t>(node)] >= 0;
      });
  hold(part.cut, model.supports);
  // A part without a cut is the whole body, which only the scene's supports hold.
  if (cut.empty()) {
    check_held(scene_, model);
  }
  model.contact = make_contact_surface(model.mesh);
  model.contact_spacing_m = contact_spacing_m_;
  part.stiffness = scene_stiffness(scene_, model.mesh, model.material);
  model.factor.emplace(reduce(part.stiffness, model.supports));
  return part;
}

std::string CutOutSolver::text() const {
  return fmt::format(
      "parts within {} m of their nodes are cut out of a mesh of {} tets{}",
      scene_.cutout->radius_m, tets().tet.rows(),
      coarse_ ? fmt::format(", a coarse body of {} tets and {} unknowns stands behind "
                            "the cuts",
                            coarse_->model().mesh.tet.rows(),
                            coarse_->model().supports.free)
              : ", clamped at the cuts");
}

SurfaceCompliance CutOutSolver::compliance(const ClampedPart& part,
                                           std::span<const PressedNode> nodes,
                                           const CoarseBody* exterior) {
  SurfaceCompliance compliance = compliance_of(part.model, nodes, {}, nullptr);
  std::vector<std::int32_t> touched;
  for (const PressedNode& node : nodes) {
    touched.insert(touched.end(), node.patch.begin(), node.patch.end());
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  if (exterior != nullptr && !part.cut.empty() && !touched.empty()) {
    // The clamped part's compliance lacks the motion of the cut; the coarse body adds
    // it.
    compliance.add(touched, exterior->exterior_compliance(part, touched));
  }
  return compliance;
}

std::vector<PressedNode> CutOutSolver::press_on(
    const ClampedPart& part, const SharedTool& tool,
    std::span<const std::int32_t> group) const {
  std::vector<PressedNode> nodes;
  for (const std::int32_t vertex : group) {
    nodes.push_back(placed_node(scene_, body_, part.model, tool, vertex));
  }
  const SurfaceCompliance among = compliance(part, nodes, coarse_.get());
  for (PressedNode& node : nodes) {
    press_linear(part.model, among, node);
  }
  return nodes;
}

std::vector<PressedNode> CutOutSolver::press(const SharedTool& tool,
                                             std::span<const std::int32_t> group,
                                             double times_wider) const {
  const double radius_m = times_wider * scene_.cutout->radius_m;
  std::vector<PressedNode> nodes;
  bool whole = false;
  {
    const ClampedPart part = this->part(group, radius_m);
    whole = part.cut.empty();
    nodes = press_on(part, tool, group);
  }
  if (!whole) {
    estimate(nodes, group, radius_m / kCutStep);
  }
  return nodes;
}

// The last depths once more in a narrower cut, before a coarser body. An error of order
// a/R or higher grows by half or more on the way there: twice the difference bounds it.
void CutOutSolver::estimate(std::span<PressedNode> nodes,
                            std::span<const std::int32_t> group,
                            double radius_m) const {
  const ClampedPart part = this->part(group, radius_m);
  std::vector<PressedNode> narrow;
  for (const PressedNode& node : nodes) {
    narrow.push_back(
        placed_node(scene_, body_, part.model, node.path.tool, node.vertex));
  }
  const SurfaceCompliance among = compliance(part, narrow, coarser_.get());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    Indentation& wide = nodes[i].indentation;
    if (wide.sample.size() < 2) {
      continue;
    }
    // One sample at the wide press's last depth, without a limit of force.
    narrow[i].path.depth_max_m = wide.sample.back().penetration_m;
    narrow[i].path.force_max_n = std::numeric_limits<double>::infinity();
    narrow[i].path.samples = 1;
    press_linear(part.model, among, narrow[i]);
    // An error of order 1/R grows by the factor kCutStep in the narrower cut. It is
    // therefore the difference over (kCutStep - 1).
    wide.exterior_error_relative = 1.0;
    if (narrow[i].indentation.sample.size() > 1) {
      const double wide_n = wide.sample.back().force_n.norm();
      const double narrow_n = narrow[i].indentation.sample.back().force_n.norm();
      if (wide_n > 0.0) {
        wide.exterior_error_relative =
            std::abs(narrow_n / wide_n - 1.0) / (kCutStep - 1.0);
      }
    }
  }
}

}  // namespace palpate
