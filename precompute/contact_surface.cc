#include "precompute/contact_surface.h"

#include <algorithm>
#include <array>

#include <Eigen/Geometry>

namespace palpate {
namespace {

using Bary = Eigen::Vector3d;  // barycentric coordinates on the parent face

// The six nodes of a face and its four sub-triangles, all of equal area.
Bary face_node(int j) {
  return j < 3 ? Bary(Bary::Unit(j))
               : Bary(0.5 * (Bary::Unit(j - 3) + Bary::Unit((j - 2) % 3)));
}

constexpr std::array<std::array<int, 3>, 4> kSubTriangle{
    {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};

// Degree-4 rule on a triangle (Strang and Fix 1973), weights sum to 1.
struct RulePoint {
  Bary at;
  double weight;
};

std::array<RulePoint, 6> triangle_rule() {
  constexpr double kA = 0.445948490915965;
  constexpr double kB = 0.091576213509771;
  constexpr double kWeightA = 0.223381589678011;
  constexpr double kWeightB = 0.109951743655322;
  const auto point = [](double c, int apex, double weight) {
    Bary at = Bary::Constant(c);
    at[apex] = 1.0 - 2.0 * c;
    return RulePoint{at, weight};
  };
  return {point(kA, 0, kWeightA), point(kA, 1, kWeightA), point(kA, 2, kWeightA),
          point(kB, 0, kWeightB), point(kB, 1, kWeightB), point(kB, 2, kWeightB)};
}

Eigen::Matrix<double, 6, 1> quadratic_shape(const Bary& L) {
  Eigen::Matrix<double, 6, 1> N;
  N << L[0] * (2 * L[0] - 1), L[1] * (2 * L[1] - 1), L[2] * (2 * L[2] - 1),
      4 * L[0] * L[1], 4 * L[1] * L[2], 4 * L[2] * L[0];
  return N;
}

// A point of a face's quadrature: where, its weight as a share of the face's area, and
// the values of the six hats and six shape functions there.
struct FacePoint {
  Bary at;
  double area_share = 0.0;
  Eigen::Matrix<double, 6, 1> hat;
  Eigen::Matrix<double, 6, 1> shape;
};

std::vector<FacePoint> face_points() {
  std::vector<FacePoint> points;
  for (const auto& sub : kSubTriangle) {
    for (const RulePoint& rule : triangle_rule()) {
      FacePoint point;
      point.at.setZero();
      point.hat.setZero();
      for (int k = 0; k < 3; ++k) {
        const int node = sub[static_cast<std::size_t>(k)];
        point.at += rule.at[k] * face_node(node);
        point.hat[node] = rule.at[k];
      }
      point.area_share = rule.weight / 4.0;
      point.shape = quadratic_shape(point.at);
      points.push_back(point);
    }
  }
  return points;
}

void add_load(ContactNode& node, std::int32_t mesh_node, const Eigen::Vector3d& force) {
  for (NodalForce& entry : node.load) {
    if (entry.node == mesh_node) {
      entry.force += force;
      return;
    }
  }
  node.load.push_back({mesh_node, force});
}

void sort_unique(std::vector<std::int32_t>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

// From integrals over the hat to averages: everything is divided by the hat's area.
void normalise(ContactNode& node) {
  for (GapPoint& point : node.gap_points) {
    point.weight /= node.area_m2;
  }
  for (NodalForce& entry : node.load) {
    entry.force /= node.area_m2;
  }
  node.normal.normalize();
  sort_unique(node.neighbours);
}

// A contact node for every node of the mesh's surface, still without area.
ContactSurface bare_nodes(const QuadraticMesh& mesh) {
  ContactSurface surface;
  surface.of_mesh_node.assign(static_cast<std::size_t>(mesh.position_m.rows()), -1);
  for (const std::int32_t mesh_node : surface_nodes(mesh)) {
    surface.of_mesh_node[static_cast<std::size_t>(mesh_node)] =
        static_cast<std::int32_t>(surface.node.size());
    ContactNode node;
    node.mesh_node = mesh_node;
    node.position_m = mesh.position_m.row(mesh_node).transpose();
    node.is_corner = mesh_node < mesh.corners;
    node.normal.setZero();
    surface.node.push_back(std::move(node));
  }
  return surface;
}

using FaceNodes = std::array<ContactNode*, 6>;

// The face's share of its nodes' hats: area, normal, gap points and loads.
void integrate(const QuadraticMesh& mesh, Eigen::Index face,
               const std::vector<FacePoint>& points, const FaceNodes& nodes) {
  Eigen::Matrix3d corner;
  for (int j = 0; j < 3; ++j) {
    corner.col(j) = mesh.position_m.row(mesh.surface(face, j)).transpose();
  }
  const Eigen::Vector3d area_vector =
      0.5 * (corner.col(1) - corner.col(0)).cross(corner.col(2) - corner.col(0));
  const double area = area_vector.norm();
  const Eigen::Vector3d normal = area_vector / area;
  for (const FacePoint& point : points) {
    for (int j = 0; j < 6; ++j) {
      const double weight = point.hat[j] * point.area_share * area;
      if (weight == 0.0) {
        continue;
      }
      ContactNode& node = *nodes[static_cast<std::size_t>(j)];
      node.area_m2 += weight;
      node.normal += weight * normal;
      node.gap_points.push_back({corner * point.at, normal, weight});
      for (int a = 0; a < 6; ++a) {
        add_load(node, mesh.surface(face, a), -weight * point.shape[a] * normal);
      }
    }
  }
}

void join(const ContactSurface& surface, const FaceNodes& nodes) {
  for (const auto& sub : kSubTriangle) {
    for (std::size_t k = 0; k < 3; ++k) {
      ContactNode& node = *nodes[static_cast<std::size_t>(sub[k])];
      for (const std::size_t other : {(k + 1) % 3, (k + 2) % 3}) {
        const ContactNode& next = *nodes[static_cast<std::size_t>(sub[other])];
        node.neighbours.push_back(
            surface.of_mesh_node[static_cast<std::size_t>(next.mesh_node)]);
      }
    }
  }
}

}  // namespace

ContactSurface make_contact_surface(const QuadraticMesh& mesh) {
  ContactSurface surface = bare_nodes(mesh);
  const std::vector<FacePoint> points = face_points();
  for (Eigen::Index face = 0; face < mesh.surface.rows(); ++face) {
    FaceNodes nodes{};
    for (int j = 0; j < 6; ++j) {
      const auto mesh_node = static_cast<std::size_t>(mesh.surface(face, j));
      nodes[static_cast<std::size_t>(j)] =
          &surface.node[static_cast<std::size_t>(surface.of_mesh_node[mesh_node])];
    }
    integrate(mesh, face, points, nodes);
    join(surface, nodes);
  }
  for (ContactNode& node : surface.node) {
    normalise(node);
  }
  return surface;
}

}  // namespace palpate
