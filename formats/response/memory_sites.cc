#include "formats/response/memory_sites.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "formats/base/reproducible.h"

namespace palpate {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// Farthest that a node may lie from every site, in spacings.
constexpr double kCovered = 0.75;
// Sites that may stand around a node lie within so many spacings along the edges.
constexpr double kAround = 2.6;
// And are so many at most, the nearest ones.
constexpr std::size_t kCandidates = 12;
// Area coordinates this little below zero are inside; of circles, their radius.
constexpr double kInside = 1e-9;

std::size_t as_index(std::int32_t i) {
  return static_cast<std::size_t>(i);
}

// Straight distances, to what the surface's edges lead to.
class EdgeGraph {
 public:
  explicit EdgeGraph(const SurfaceMesh& body)
      : position_m_(body.position_m),
        neighbours_(vertex_neighbours(body.position_m.rows(), body.triangle)) {}

  // Visits `from` and what edges lead to within limit_m, on from where `visit` says so.
  template <typename Visit>
  void walk(std::int32_t from, double limit_m, const Visit& visit) const {
    std::vector<std::int32_t> front{from};
    for (std::size_t i = 0; i < front.size(); ++i) {
      const std::int32_t node = front[i];
      if (!visit(node, (position_m_.row(node) - position_m_.row(from)).norm())) {
        continue;
      }
      for (const std::int32_t next : neighbours_[as_index(node)]) {
        if ((position_m_.row(next) - position_m_.row(from)).norm() <= limit_m) {
          front.push_back(next);
        }
      }
    }
  }

 private:
  const Points& position_m_;
  std::vector<std::vector<std::int32_t>> neighbours_;
};

std::vector<std::int32_t> farthest_points(const EdgeGraph& graph,
                                          const std::vector<bool>& remembers,
                                          double covered_m) {
  std::vector<double> distance(remembers.size(), kInfinite);
  std::vector<std::int32_t> sites;
  while (true) {
    std::int32_t farthest = -1;
    for (std::size_t i = 0; i < remembers.size(); ++i) {
      if (remembers[i] &&
          (farthest < 0 || distance[i] > distance[as_index(farthest)])) {
        farthest = static_cast<std::int32_t>(i);
      }
    }
    if (farthest < 0 || !(distance[as_index(farthest)] > covered_m)) {
      return sites;
    }
    sites.push_back(farthest);
    graph.walk(farthest, kInfinite, [&](std::int32_t node, double reached) {
      const bool nearer = reached < distance[as_index(node)];
      distance[as_index(node)] = std::min(distance[as_index(node)], reached);
      return nearer;
    });
  }
}

// A site as a node sees it in its tangent plane.
struct Seen {
  std::int32_t site = -1;
  Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
};

struct Circle {
  Eigen::Vector2d centre_m;
  double radius_m = kInfinite;
};

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

Circle circle_through(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                      const Eigen::Vector2d& c) {
  const Eigen::Vector2d u = b - a;
  const Eigen::Vector2d v = c - a;
  const double area = 2.0 * cross(u, v);
  const Eigen::Vector2d from(
      (v.y() * u.squaredNorm() - u.y() * v.squaredNorm()) / area,
      (u.x() * v.squaredNorm() - v.x() * u.squaredNorm()) / area);
  return {a + from, from.norm()};
}

using Weights = std::vector<std::pair<std::int32_t, double>>;

bool is_empty(const Circle& circle, const std::vector<Seen>& seen) {
  return std::none_of(seen.begin(), seen.end(), [&](const Seen& other) {
    return (other.at_m - circle.centre_m).norm() < circle.radius_m * (1.0 - kInside);
  });
}

// Of Delaunay's triangle of sites around the origin, whose circle holds no site; empty
// if there is none.
Weights triangle_around(const std::vector<Seen>& seen) {
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (std::size_t j = i + 1; j < seen.size(); ++j) {
      for (std::size_t k = j + 1; k < seen.size(); ++k) {
        const Eigen::Vector2d& a = seen[i].at_m;
        const Eigen::Vector2d& b = seen[j].at_m;
        const Eigen::Vector2d& c = seen[k].at_m;
        const double area = cross(b - a, c - a);
        const Eigen::Vector3d w(cross(b, c) / area, cross(c, a) / area,
                                cross(a, b) / area);
        if (w.minCoeff() >= -kInside && is_empty(circle_through(a, b, c), seen)) {
          return {{seen[i].site, w(0)}, {seen[j].site, w(1)}, {seen[k].site, w(2)}};
        }
      }
    }
  }
  return {};
}

// Without a triangle: along the line between the two nearest sites.
Weights nearest_two(const std::vector<Seen>& seen) {
  if (seen.empty()) {
    return {};
  }
  if (seen.size() == 1) {
    return {{seen[0].site, 1.0}};
  }
  const Eigen::Vector2d line = seen[1].at_m - seen[0].at_m;
  const double t = std::clamp(-seen[0].at_m.dot(line) / line.squaredNorm(), 0.0, 1.0);
  return {{seen[0].site, 1.0 - t}, {seen[1].site, t}};
}

// The nearest of some sites, in the tangent plane of a node.
std::vector<Seen> sites_around(const SurfaceMesh& body, const Points& normal,
                               const std::vector<std::int32_t>& sites,
                               const std::vector<std::int32_t>& around,
                               std::int32_t node) {
  const Eigen::Vector3d n = normal.row(node);
  const Eigen::Vector3d along = n.unitOrthogonal();
  const Eigen::Vector3d across = n.cross(along);
  std::vector<Seen> seen;
  for (const std::int32_t site : around) {
    const Eigen::Vector3d r =
        (body.position_m.row(sites[as_index(site)]) - body.position_m.row(node))
            .transpose();
    seen.push_back({site, {r.dot(along), r.dot(across)}});
  }
  std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) {
    const double first = a.at_m.squaredNorm();
    const double second = b.at_m.squaredNorm();
    return first != second ? first < second : a.site < b.site;
  });
  seen.resize(std::min(seen.size(), kCandidates));
  return seen;
}

void set_row(MemorySites& sites, std::int32_t node, const Weights& weights) {
  double sum = 0.0;
  for (const auto& [site, weight] : weights) {
    sum += std::max(0.0, weight);
  }
  Eigen::Index column = 0;
  for (const auto& [site, weight] : weights) {
    if (weight > kInside) {
      sites.site(node, column) = site;
      sites.weight(node, column++) = static_cast<float>(weight / sum);
    }
  }
}

// Radius of a mesh tool's section at a height over its lowest point.
double section_radius_m(const SurfaceMesh& mesh, double height_m) {
  const double plane = mesh.position_m.col(2).minCoeff() + height_m;
  double radius = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      const Eigen::Vector3d a = mesh.position_m.row(mesh.triangle(t, j));
      const Eigen::Vector3d b = mesh.position_m.row(mesh.triangle(t, (j + 1) % 3));
      if ((a.z() - plane) * (b.z() - plane) <= 0.0 && a.z() != b.z()) {
        const Eigen::Vector3d p = a + (plane - a.z()) / (b.z() - a.z()) * (b - a);
        radius = std::max(radius, p.head<2>().norm());
      }
    }
  }
  return radius;
}

}  // namespace

double contact_radius_m(const ToolShape& tool, double depth_m) {
  if (tool.kind == "flat-punch") {
    return tool.radius_m;
  }
  if (tool.kind == "cone") {
    const double flank =
        2.0 * depth_m * reproducible::tan(tool.half_angle_rad) / std::numbers::pi;
    return std::max(flank, std::sqrt(tool.tip_radius_m * depth_m));
  }
  if (tool.kind == "mesh") {
    // Of a sphere the section is sqrt(2) times as wide as the contact.
    const double face = section_radius_m(tool.mesh, 1e-6 * depth_m);
    return std::max(face, section_radius_m(tool.mesh, depth_m) / std::numbers::sqrt2);
  }
  return std::sqrt(tool.radius_m * depth_m);
}

double site_spacing_m(const ToolShape& tool, double depth_max_m) {
  return 2.0 * contact_radius_m(tool, 0.5 * depth_max_m);
}

MemorySites place_sites(const SurfaceMesh& body, const Points& normal,
                        const std::vector<bool>& remembers, double spacing_m) {
  const EdgeGraph graph(body);
  const auto n = static_cast<std::int32_t>(body.position_m.rows());
  MemorySites sites;
  sites.spacing_m = spacing_m;
  sites.node = farthest_points(graph, remembers, kCovered * spacing_m);
  sites.site.setConstant(n, kMostNodeSites, -1);
  sites.weight.setZero(n, kMostNodeSites);
  // Which sites are near a node: a walk from each site along edges, to kAround
  // spacings. The sites come one after another, so that the last one known shows a
  // second visit.
  std::vector<std::vector<std::int32_t>> around(remembers.size());
  for (std::size_t s = 0; s < sites.node.size(); ++s) {
    graph.walk(sites.node[s], kAround * spacing_m, [&](std::int32_t node, double) {
      std::vector<std::int32_t>& known = around[as_index(node)];
      const auto site = static_cast<std::int32_t>(s);
      const bool first = known.empty() || known.back() != site;
      if (first) {
        known.push_back(site);
      }
      return first;
    });
  }
  for (std::size_t s = 0; s < sites.node.size(); ++s) {
    set_row(sites, sites.node[s], {{static_cast<std::int32_t>(s), 1.0}});
  }
  for (std::int32_t i = 0; i < n; ++i) {
    if (!remembers[as_index(i)] || sites.site(i, 0) >= 0) {
      continue;
    }
    // Area coordinates in the triangle of sites around the node; at a border shares of
    // the two nearest.
    const std::vector<Seen> seen =
        sites_around(body, normal, sites.node, around[as_index(i)], i);
    const Weights inside = triangle_around(seen);
    set_row(sites, i, inside.empty() ? nearest_two(seen) : inside);
  }
  return sites;
}

double mean_spacing_m(const MemorySites& sites, const Points& position_m) {
  double sum = 0.0;
  for (std::size_t i = 0; i < sites.node.size(); ++i) {
    double nearest = kInfinite;
    for (std::size_t j = 0; j < sites.node.size(); ++j) {
      if (i != j && sites.node[i] >= 0 && sites.node[j] >= 0) {
        nearest = std::min(
            nearest,
            (position_m.row(sites.node[i]) - position_m.row(sites.node[j])).norm());
      }
    }
    sum += std::isfinite(nearest) ? nearest : 0.0;
  }
  return sites.node.size() < 2 ? 0.0 : sum / static_cast<double>(sites.node.size());
}

}  // namespace palpate
