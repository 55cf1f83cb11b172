#include "precompute/body/meshed_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/contact/tool_surface.h"
#include "precompute/process/machine_memory.h"
#include "precompute/surface/coarsen_surface.h"
#include "precompute/surface/refine_surface.h"
#include "precompute/surface/subdivide.h"
#include "precompute/tets/tetrahedralise.h"

namespace palpate {
namespace {

// Edges of the far surface over what the mesh would have there; the shorter ones where
// the coarse surface crosses itself.
constexpr std::array<double, 3> kFarShares{0.3, 0.15, 0.08};

// Nodes of the mesh that are held, and points of its surface that stand on springs.
std::vector<Eigen::Vector3d> supported_m(const Scene& scene, const BodyModel& model) {
  std::vector<Eigen::Vector3d> points;
  const auto position = [&](std::int32_t node) -> Eigen::Vector3d {
    return model.mesh.position_m.row(node).transpose();
  };
  for (Eigen::Index node = 0; node < model.mesh.position_m.rows(); ++node) {
    if (model.supports.free_index[3 * static_cast<std::size_t>(node)] < 0) {
      points.push_back(position(static_cast<std::int32_t>(node)));
    }
  }
  for (const SceneSupport& support : scene.support) {
    for (Eigen::Index f = 0; !support.is_fixed() && f < model.mesh.surface.rows();
         ++f) {
      for_points_there(
          model.mesh, f,
          [&](const Eigen::Vector3d& p) {
            return holds(support, p);
          },
          [&](const Eigen::Vector3d& p_m, std::size_t) {
            points.push_back(p_m);
          });
    }
  }
  return points;
}

// Whether a body that is held at these points could still turn about a line.
bool in_a_line(const std::vector<Eigen::Vector3d>& points, double extent_m) {
  if (points.size() < 3) {
    return true;
  }
  Eigen::MatrixX3d p(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    p.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
  }
  p.rowwise() -= p.colwise().mean().eval();
  // Principal moments of the points ascend: the middle one is 0 on a line.
  const Eigen::Matrix3d spread = p.transpose() * p;
  const auto moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread);
  // Closer to a line than this, turning about it costs less than rounding.
  return !(std::sqrt(moments.eigenvalues()[1]) > 1e-6 * extent_m);
}

}  // namespace

UniformSurface uniform_surface(const BodySource& body, double spacing_m,
                               Eigen::Index triangles_max) {
  UniformSurface fine{.surface = body.surface};
  while (0.5 * mean_edge_m(fine.surface) > spacing_m) {
    if (4 * fine.surface.triangle.rows() > triangles_max) {
      fine.fine_enough = false;
      break;
    }
    fine.surface = subdivide_midpoint(fine.surface);
    ++fine.subdivisions;
  }
  fine.node_spacing_m = 0.5 * mean_edge_m(fine.surface);
  return fine;
}

UniformSurface pressed_surface(const BodySource& body,
                               std::span<const std::int32_t> vertices, double spacing_m,
                               double reach_m, Eigen::Index triangles_max) {
  constexpr double kGrowth = 0.5;
  // Halving leaves edges between a half and the whole of what is wanted: with this
  // their mean is twice the spacing.
  const ContactFocus focus{
      .growth = kGrowth, .finest_m = 1.4 * 2.0 * spacing_m, .core_m = reach_m};
  UniformSurface fine;
  fine.surface = refine_longest_edge(
      body.surface, wanted_edges(body.surface, vertices, focus), triangles_max);
  fine.fine_enough = fine.surface.triangle.rows() <= triangles_max;
  fine.node_spacing_m = spacing_m;
  return fine;
}

std::int64_t contact_nodes_near(const SurfaceMesh& surface, const BodySource& body,
                                std::span<const std::int32_t> vertices,
                                double reach_m) {
  // Edges grow from nothing beyond the reach: what is wanted there is positive.
  const EdgeLength beyond = wanted_edges(
      body.surface, vertices, {.growth = 1.0, .finest_m = 0.0, .core_m = reach_m});
  std::int64_t count = 0;
  for (Eigen::Index v = 0; v < surface.position_m.rows(); ++v) {
    count += beyond(surface.position_m.row(v).transpose()) > 0.0 ? 0 : 2;
  }
  for (Eigen::Index t = 0; t < surface.triangle.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      const auto a = surface.position_m.row(surface.triangle(t, j));
      const auto b = surface.position_m.row(surface.triangle(t, (j + 1) % 3));
      count += beyond(0.5 * (a + b).transpose()) > 0.0 ? 0 : 1;  // seen from both sides
    }
  }
  return count / 2;
}

void check_held(const Scene& scene, const BodyModel& model) {
  const Eigen::Vector3d low = model.mesh.position_m.colwise().minCoeff();
  const Eigen::Vector3d high = model.mesh.position_m.colwise().maxCoeff();
  const std::vector<Eigen::Vector3d> points = supported_m(scene, model);
  if (in_a_line(points, (high - low).norm())) {
    throw InputError(fmt::format(
        "the supports hold {} surface nodes, at least 3 that are not in a line are "
        "needed; the body fills ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) m",
        points.size(), low.x(), low.y(), low.z(), high.x(), high.y(), high.z()));
  }
}

Supports scene_supports(const Scene& scene, const QuadraticMesh& mesh) {
  return hold_where(mesh, [&](const Eigen::Vector3d& p) {
    return is_held(scene, p);
  });
}

Stiffness scene_stiffness(const Scene& scene, const QuadraticMesh& mesh,
                          std::span<const Material> material) {
  Stiffness K = assemble_stiffness(mesh, material);
  for (const SceneSupport& support : scene.support) {
    if (!support.is_fixed()) {
      add_foundation(K, mesh, support.stiffness_pa_per_m,
                     [&](const Eigen::Vector3d& p) {
                       return holds(support, p);
                     });
    }
  }
  return K;
}

FilledBody filled_body(const BodySource& body, const SurfaceMesh& surface) {
  require_memory(surface.triangle.rows());
  FilledBody filled{surface, tetrahedralise(surface, {}, body.inner)};
  if (std::none_of(body.inner.begin(), body.inner.end(), [](const InnerSurface& one) {
        return one.cut;
      })) {
    return filled;
  }
  return cut_regions(body.surface, body.inner, std::move(filled));
}

namespace {

BodyModel model_of(const Scene& scene, const BodySource& body, const FilledBody& filled,
                   bool keep_stiffness) {
  const auto& [surface, tets] = filled;
  BodyModel model;
  model.min_dihedral_deg =
      tet_quality(tets).smallest_dihedral_rad * 180.0 / std::numbers::pi;
  model.mesh = make_quadratic(tets, surface.triangle);
  model.material = body.material;
  model.supports = scene_supports(scene, model.mesh);
  check_held(scene, model);
  model.contact = make_contact_surface(model.mesh);
  model.contact_spacing_m = 0.5 * mean_edge_m(surface);
  Stiffness K =
      reduce(scene_stiffness(scene, model.mesh, model.material), model.supports);
  model.factor.emplace(K);
  if (keep_stiffness) {
    model.stiffness.swap(K);
  }
  return model;
}

}  // namespace

BodyModel make_body_model(const Scene& scene, const BodySource& body,
                          const SurfaceMesh& surface) {
  return model_of(scene, body, filled_body(body, surface), false);
}

std::int32_t corner_of(const BodyModel& model, std::int32_t vertex) {
  return model.corner.empty() ? vertex : model.corner.at(vertex);
}

int support_part(const Scene& scene, const Eigen::Vector3d& p_m) {
  int part = 0;
  for (std::size_t i = 0; i < scene.support.size(); ++i) {
    part |= holds(scene.support[i], p_m) ? 1 << (i % 31) : 0;
  }
  return part;
}

namespace {

// Coarse where it is far, and no finer than before where it is near.
CoarsenedSurface far_coarsened(const Scene& scene, const BodySource& body,
                               std::span<const std::int32_t> vertices,
                               const ContactFocus& focus, double far_share) {
  ContactFocus far = focus;
  far.growth *= far_share;
  return coarsen_surface(body.surface, wanted_edges(body.surface, vertices, far),
                         vertices, [&](const Eigen::Vector3d& p) {
                           return support_part(scene, p);
                         });
}

}  // namespace

SurfaceMesh graded_surface(const Scene& scene, const BodySource& body,
                           std::span<const std::int32_t> vertices,
                           const ContactFocus& focus) {
  const auto wanted = wanted_edges(body.surface, vertices, focus);
  return refine_longest_edge(
      body.inner.empty()
          ? far_coarsened(scene, body, vertices, focus, kFarShares.front()).surface
          : body.surface,
      wanted, 4 * kMostTriangles);
}

namespace {

// A refined surface and the tets that fill it.
struct GradedBody {
  FilledBody filled;
  std::vector<std::int32_t> corner;  // of the vertices; empty: the body's own
};

GradedBody graded_tets(const Scene& scene, const BodySource& body,
                       std::span<const std::int32_t> vertices,
                       const ContactFocus& focus) {
  const auto wanted = wanted_edges(body.surface, vertices, focus);
  const auto fill = [&](const SurfaceMesh& coarse, std::vector<std::int32_t> corner) {
    const SurfaceMesh surface = refine_longest_edge(coarse, wanted, 4 * kMostTriangles);
    return GradedBody{filled_body(body, surface), std::move(corner)};
  };
  if (!body.inner.empty()) {
    return fill(body.surface, {});  // inner surfaces might cross a coarse one
  }
  for (const double far_share : kFarShares) {
    try {
      const CoarsenedSurface coarse =
          far_coarsened(scene, body, vertices, focus, far_share);
      return fill(coarse.surface, coarse.vertex);
    } catch (const NumericalError&) {
      // The coarse surface crosses itself; a finer one costs more.
    }
  }
  return fill(body.surface, {});
}

// Shape of the poorest tet where the tool touches.
double poorest_shape(const TetMesh& tets, const EdgeLength& beyond) {
  double poorest = 1.0;
  for (Eigen::Index t = 0; t < tets.tet.rows(); ++t) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const std::int32_t corner : tets.tet.row(t)) {
      middle += 0.25 * tets.position_m.row(corner).transpose();
    }
    if (beyond(middle) <= 0.0) {
      poorest = std::min(poorest, tet_shape(tets, t));
    }
  }
  return poorest;
}

// Of surfaces that differ a little the first whose tets are well shaped where the tool
// touches, else the best: where the mesher gives up improving them is a matter of
// chance.
GradedBody well_filled(const Scene& scene, const BodySource& body,
                       std::span<const std::int32_t> vertices,
                       const ContactFocus& focus) {
  constexpr std::array<double, 3> kTimesFiner{1.07, 0.93, 1.15};
  constexpr double kWellShaped = 0.01;
  const EdgeLength beyond = wanted_edges(
      body.surface, vertices,
      {.growth = 1.0,
       .finest_m = 0.0,
       .core_m = touched_radius_m(scene, body, 0.5 * focus.growth * focus.contact_m)});
  GradedBody best = graded_tets(scene, body, vertices, focus);
  double shape = poorest_shape(best.filled.tets, beyond);
  for (const double times : kTimesFiner) {
    if (shape > kWellShaped) {
      break;
    }
    try {
      GradedBody other = graded_tets(scene, body, vertices, finer(focus, times));
      const double other_shape = poorest_shape(other.filled.tets, beyond);
      if (other_shape > shape) {
        best = std::move(other);
        shape = other_shape;
      }
    } catch (const NumericalError&) {
      // The first can be meshed, if not well.
    }
  }
  return best;
}

}  // namespace

BodyModel make_graded_model(const Scene& scene, const BodySource& body,
                            std::span<const std::int32_t> vertices,
                            const ContactFocus& focus, bool keep_stiffness) {
  const GradedBody made = well_filled(scene, body, vertices, focus);
  BodyModel model = model_of(scene, body, made.filled, keep_stiffness);
  model.contact_spacing_m = 0.5 * focus.growth * focus.contact_m;
  for (std::size_t i = 0; i < made.corner.size(); ++i) {
    model.corner.emplace(vertices[i], made.corner[i]);
  }
  return model;
}

}  // namespace palpate
