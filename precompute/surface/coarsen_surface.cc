#include "precompute/surface/coarsen_surface.h"

#include <cmath>

#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include "precompute/surface/cgal_surface.h"

namespace palpate {
namespace {

namespace sms = CGAL::Surface_mesh_simplification;

// Cosine of the largest angle that a collapse may turn a triangle by: 25 degrees.
constexpr double kMostTurn = 0.9063077870366499;

Eigen::Vector3d vector_of(const CgalKernel::Point_3& p) {
  return {p.x(), p.y(), p.z()};
}

Eigen::Vector3d triangle_normal(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                const Eigen::Vector3d& c) {
  return (b - a).cross(c - a);
}

// Where an edge may go: nowhere if that would break a promise of coarsen_surface().
class Placement {
 public:
  Placement(const EdgeLength& wanted,
            const std::function<int(const Eigen::Vector3d&)>& part,
            const std::vector<char>& kept)
      : wanted_(&wanted), part_(&part), kept_(&kept) {}

  template <typename Profile>
  boost::optional<CgalKernel::Point_3> operator()(const Profile& profile) const {
    if (is_kept(profile.v0()) || is_kept(profile.v1())) {
      return boost::none;
    }
    boost::optional<CgalKernel::Point_3> to = best_(profile);
    if (!to) {
      return boost::none;
    }
    const Eigen::Vector3d p = vector_of(*to);
    const int part = (*part_)(vector_of(profile.p0()));
    if (part != (*part_)(vector_of(profile.p1())) || part != (*part_)(p) ||
        !fits(profile, p, part)) {
      return boost::none;
    }
    return to;
  }

 private:
  template <typename Vertex>
  [[nodiscard]] bool is_kept(const Vertex& v) const {
    return (*kept_)[v.idx()] != 0;
  }

  template <typename Profile>
  [[nodiscard]] bool fits(const Profile& profile, const Eigen::Vector3d& p,
                          int part) const {
    // No new edge is longer than wanted, and none joins two parts.
    const double longest = (*wanted_)(p);
    const auto& mesh = profile.surface_mesh();
    for (const auto v : profile.link()) {
      const Eigen::Vector3d q = vector_of(mesh.point(v));
      if ((q - p).norm() > longest || (*part_)(q) != part) {
        return false;
      }
    }
    // No triangle that stays turns by more than 25 degrees. Two with both ends vanish.
    for (const auto& triangle : profile.triangles()) {
      const auto at = [&](auto v) {
        return v == profile.v0() || v == profile.v1() ? p : vector_of(mesh.point(v));
      };
      const Eigen::Vector3d before = triangle_normal(
          vector_of(mesh.point(triangle.v0)), vector_of(mesh.point(triangle.v1)),
          vector_of(mesh.point(triangle.v2)));
      const Eigen::Vector3d after =
          triangle_normal(at(triangle.v0), at(triangle.v1), at(triangle.v2));
      const bool gone = (triangle.v0 == profile.v0() || triangle.v1 == profile.v0() ||
                         triangle.v2 == profile.v0()) &&
                        (triangle.v0 == profile.v1() || triangle.v1 == profile.v1() ||
                         triangle.v2 == profile.v1());
      if (!gone && !(before.dot(after) > kMostTurn * before.norm() * after.norm())) {
        return false;
      }
    }
    return true;
  }

  sms::LindstromTurk_placement<CgalMesh> best_;
  const EdgeLength* wanted_;
  const std::function<int(const Eigen::Vector3d&)>* part_;
  const std::vector<char>* kept_;
};

struct NeverStop {
  template <typename Cost, typename Profile, typename Size>
  bool operator()(const Cost& /*cost*/, const Profile& /*profile*/, Size /*initial*/,
                  Size /*current*/) const {
    return false;
  }
};

}  // namespace

CoarsenedSurface coarsen_surface(
    const SurfaceMesh& surface, const EdgeLength& wanted,
    std::span<const std::int32_t> kept,
    const std::function<int(const Eigen::Vector3d&)>& part) {
  std::vector<char> is_kept(static_cast<std::size_t>(surface.position_m.rows()), 0);
  for (const std::int32_t v : kept) {
    is_kept[static_cast<std::size_t>(v)] = 1;
  }
  CgalMesh mesh = to_cgal(surface);
  const auto original =
      mesh.add_property_map<CgalMesh::Vertex_index, std::int32_t>("v:original").first;
  for (const auto v : mesh.vertices()) {
    original[v] = static_cast<std::int32_t>(v.idx());
  }
  sms::edge_collapse(mesh, NeverStop{},
                     CGAL::parameters::get_cost(sms::LindstromTurk_cost<CgalMesh>())
                         .get_placement(Placement(wanted, part, is_kept)));
  // Closing the gaps moves vertices about; their properties go with them.
  mesh.collect_garbage();
  std::vector<std::int32_t> now(is_kept.size(), -1);
  for (const auto v : mesh.vertices()) {
    now[static_cast<std::size_t>(original[v])] = static_cast<std::int32_t>(v.idx());
  }
  CoarsenedSurface result{.surface = from_cgal(std::move(mesh)), .vertex = {}};
  for (const std::int32_t v : kept) {
    result.vertex.push_back(now[static_cast<std::size_t>(v)]);
  }
  return result;
}

}  // namespace palpate
