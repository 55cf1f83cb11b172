#include "precompute/body/mesh_grading.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "formats/base/reproducible.h"
#include "precompute/contact/linear_indentation.h"
#include "precompute/contact/tool_surface.h"

namespace palpate {
namespace {

// Distance to the nearest of many points: along x, outwards from the query.
class NearestOf {
 public:
  NearestOf(const SurfaceMesh& surface, std::span<const std::int32_t> vertices) {
    for (const std::int32_t v : vertices) {
      point_.emplace_back(surface.position_m.row(v).transpose());
    }
    std::sort(point_.begin(), point_.end(),
              [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
                return a.x() < b.x();
              });
  }

  [[nodiscard]] double distance_m(const Eigen::Vector3d& p) const {
    double best = std::numeric_limits<double>::infinity();
    const auto middle = std::lower_bound(point_.begin(), point_.end(), p.x(),
                                         [](const Eigen::Vector3d& a, double x) {
                                           return a.x() < x;
                                         });
    for (auto at = middle; at != point_.end() && at->x() - p.x() < best; ++at) {
      best = std::min(best, (*at - p).norm());
    }
    for (auto at = middle; at != point_.begin();) {
      --at;
      if (p.x() - at->x() >= best) {
        break;
      }
      best = std::min(best, (*at - p).norm());
    }
    return best;
  }

 private:
  std::vector<Eigen::Vector3d> point_;
};

// Interleaves ten bits of each coordinate.
std::uint32_t morton(const Eigen::Vector3d& unit) {
  std::uint32_t code = 0;
  for (int bit = 9; bit >= 0; --bit) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto cell =
          static_cast<std::uint32_t>(std::clamp(unit[axis] * 1023.0, 0.0, 1023.0));
      code = (code << 1) | ((cell >> bit) & 1U);
    }
  }
  return code;
}

// Vertices that share a mesh of their own. Few: the columns of a mesh and the non-zeros
// of its factor both grow with them, and the time of a press with their product.
constexpr double kMostInGroup = 4.0;

double growth_for(const Scene& scene) {
  if (scene.contact_resolution > 0.0) {
    return std::clamp(2.0 / scene.contact_resolution, 0.05, 1.0);
  }
  return std::clamp(0.95 * reproducible::pow(scene.force_relative / 0.05, 0.4), 0.1,
                    1.0);
}

}  // namespace

ContactFocus contact_focus(const Scene& scene, const BodySource& body) {
  ContactFocus focus{.growth = growth_for(scene),
                     .finest_m = std::numeric_limits<double>::infinity()};
  for (const auto& surface : body.tool) {
    const ToolShape& tool = surface->shape();
    const double depth = scene.reach.depth_max_m;
    const double largest = expected_contact_radius_m(tool, depth);
    double smallest =
        std::max(expected_contact_radius_m(tool, depth / 16.0), 0.25 * largest);
    if (tool.kind == "flat-punch") {
      // The pressure at the rim is singular over the edge's radius and beyond.
      focus.rim_m = std::max(focus.rim_m, tool.radius_m);
      smallest = std::max(tool.edge_radius_m, tool.radius_m / 8.0);
    }
    focus.contact_m = std::max(focus.contact_m, largest);
    focus.finest_m = std::min(focus.finest_m, focus.growth * smallest);
  }
  return focus;
}

ContactFocus finer(ContactFocus focus, double times) {
  focus.growth /= times;
  focus.finest_m /= times;
  return focus;
}

double uniform_spacing_m(const Scene& scene, const BodySource& body, bool nonlinear) {
  double contact_m = std::numeric_limits<double>::infinity();
  for (const auto& tool : body.tool) {
    contact_m = std::min(
        contact_m, expected_contact_radius_m(tool->shape(), scene.reach.depth_max_m));
  }
  return contact_m * std::min(1.0, growth_for(scene)) * (nonlinear ? 0.33 : 0.5);
}

double touched_radius_m(const Scene& scene, const BodySource& body,
                        double node_spacing_m) {
  double radius_m = 0.0;
  for (const auto& tool : body.tool) {
    const IndentationPath path{.vertex_m = Eigen::Vector3d::Zero(),
                               .outward = Eigen::Vector3d::UnitZ(),
                               .tool = tool,
                               .depth_max_m = scene.reach.depth_max_m};
    const double touched_m = patch_radius_m(path, node_spacing_m);
    radius_m = std::isfinite(touched_m) ? std::max(radius_m, touched_m) : radius_m;
  }
  return radius_m;
}

EdgeLength wanted_edges(const SurfaceMesh& surface,
                        std::span<const std::int32_t> vertices,
                        const ContactFocus& focus) {
  return [nearest = std::make_shared<NearestOf>(surface, vertices),
          focus](const Eigen::Vector3d& p) {
    // Edge length growth times the distance from the nearest pressed vertex, and from
    // the rim of a punch around that vertex; finest_m at least.
    const double r = nearest->distance_m(p);
    double wanted = focus.growth * (r - focus.core_m);
    if (focus.rim_m > 0.0) {
      wanted = std::min(wanted, focus.growth * std::abs(r - focus.rim_m));
    }
    return std::max(wanted, focus.finest_m);
  };
}

std::vector<std::vector<std::int32_t>> in_neighbourhoods(
    const SurfaceMesh& surface, std::span<const std::int32_t> vertices,
    std::size_t size) {
  const Eigen::AlignedBox3d box = bounding_box(surface);
  const double side =
      std::max(box.diagonal().maxCoeff(), std::numeric_limits<double>::min());
  std::vector<std::pair<std::uint32_t, std::int32_t>> order;
  for (const std::int32_t v : vertices) {
    const Eigen::Vector3d p = surface.position_m.row(v).transpose();
    // Vertices in the order of a Morton curve are cut into sets of equal size:
    // successive vertices are mostly neighbours.
    order.emplace_back(morton((p - box.min()) / side), v);
  }
  std::sort(order.begin(), order.end());
  const std::size_t sets = (order.size() + size - 1) / size;
  std::vector<std::vector<std::int32_t>> result(sets);
  for (std::size_t i = 0; i < order.size(); ++i) {
    result[i * sets / order.size()].push_back(order[i].second);
  }
  for (auto& set : result) {
    std::sort(set.begin(), set.end());
  }
  return result;
}

std::vector<std::vector<std::int32_t>> group_vertices(
    const SurfaceMesh& surface, std::span<const std::int32_t> vertices,
    const ContactFocus& focus) {
  const double edge = mean_edge_m(surface);
  if (edge <= 1.5 * focus.finest_m) {
    return {{vertices.begin(), vertices.end()}};
  }
  // Edges h = g r out to where they meet the body's own: 2 pi r dr / (0.43 h^2) each.
  const double inner = focus.finest_m / focus.growth;
  const double outer = std::max(edge / focus.growth, inner);
  const double own = 2.0 * std::numbers::pi / (0.43 * focus.growth * focus.growth) *
                     (0.5 + reproducible::log(outer / inner));
  const double size = static_cast<double>(surface.triangle.rows()) / own;
  return in_neighbourhoods(
      surface, vertices, static_cast<std::size_t>(std::clamp(size, 1.0, kMostInGroup)));
}

std::vector<std::vector<std::int32_t>> group_presses(
    const SurfaceMesh& surface, std::span<const std::int32_t> vertices,
    const ContactFocus& focus, bool nonlinear) {
  return nonlinear ? in_neighbourhoods(surface, vertices, 1)
                   : group_vertices(surface, vertices, focus);
}

}  // namespace palpate
