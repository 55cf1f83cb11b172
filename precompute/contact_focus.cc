#include "precompute/contact_focus.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

namespace palpate {
namespace {

// Distance to the nearest of many points: along x, outwards from the query.
class NearestPoint {
 public:
  NearestPoint(const SurfaceMesh& surface, std::span<const std::int32_t> vertices) {
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

// Radius of the contact at a depth, by Hertz: a^2 = R d.
double contact_radius_m(const ToolShape& tool, double depth_m) {
  return std::min(tool.radius_m, std::sqrt(tool.radius_m * depth_m));
}

double growth_for(const Scene& scene) {
  if (scene.contact_resolution > 0.0) {
    return 2.0 / scene.contact_resolution;
  }
  return std::clamp(0.95 * std::pow(scene.force_relative / 0.05, 0.4), 0.1, 1.0);
}

}  // namespace

ContactFocus contact_focus(const Scene& scene) {
  ContactFocus focus{.growth = growth_for(scene),
                     .finest_m = std::numeric_limits<double>::infinity()};
  for (const ToolShape& tool : scene.tool) {
    const double largest = contact_radius_m(tool, scene.reach.depth_max_m);
    const double smallest = std::max(
        contact_radius_m(tool, scene.reach.depth_max_m / 16.0), 0.25 * largest);
    focus.finest_m = std::min(focus.finest_m, focus.growth * smallest);
  }
  return focus;
}

EdgeLength wanted_edges(const SurfaceMesh& surface,
                        std::span<const std::int32_t> vertices,
                        const ContactFocus& focus) {
  return [nearest = std::make_shared<NearestPoint>(surface, vertices),
          focus](const Eigen::Vector3d& p) {
    const double r = nearest->distance_m(p);
    double wanted = focus.growth * (r - focus.core_m);
    if (focus.rim_m > 0.0) {
      wanted = std::min(wanted, focus.growth * std::abs(r - focus.rim_m));
    }
    return std::max(wanted, focus.finest_m);
  };
}

std::vector<std::vector<std::int32_t>> group_vertices(
    const SurfaceMesh& surface, std::span<const std::int32_t> vertices,
    const ContactFocus& focus) {
  const double edge = mean_edge_m(surface);
  std::size_t size = vertices.size();
  if (edge > 1.5 * focus.finest_m) {
    // Edges h = g r out to where they meet the body's own: 2 pi r dr / (0.43 h^2) each.
    const double inner = focus.finest_m / focus.growth;
    const double outer = std::max(edge / focus.growth, inner);
    const double own = 2.0 * std::numbers::pi / (0.43 * focus.growth * focus.growth) *
                       (0.5 + std::log(outer / inner));
    size = static_cast<std::size_t>(
        std::clamp(static_cast<double>(surface.triangle.rows()) / own, 1.0, 16.0));
  }
  const Eigen::AlignedBox3d box = bounding_box(surface);
  const double side =
      std::max(box.diagonal().maxCoeff(), std::numeric_limits<double>::min());
  std::vector<std::int32_t> order(vertices.begin(), vertices.end());
  const auto key = [&](std::int32_t v) {
    const Eigen::Vector3d p = surface.position_m.row(v).transpose();
    return std::pair(morton((p - box.min()) / side), v);
  };
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return key(a) < key(b);
  });
  std::vector<std::vector<std::int32_t>> groups;
  for (std::size_t first = 0; first < order.size(); first += size) {
    groups.emplace_back(order.begin() + static_cast<std::ptrdiff_t>(first),
                        order.begin() + static_cast<std::ptrdiff_t>(
                                            std::min(first + size, order.size())));
    std::sort(groups.back().begin(), groups.back().end());
  }
  return groups;
}

}  // namespace palpate
