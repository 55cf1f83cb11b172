#include "precompute/contact/contact_surface.h"

#include <algorithm>
#include <array>

#include <Eigen/Geometry>

#include "precompute/contact/face_quadrature.h"

namespace palpate {
namespace {

void add_nodal_force(ContactNode& node, std::int32_t mesh_node,
                     const Eigen::Vector3d& force) {
  for (NodalForce& entry : node.load) {
    if (entry.node == mesh_node) {
      entry.force += force;
      return;
    }
  }
  node.load.push_back({mesh_node, force});
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
  std::vector<std::int32_t>& list = node.neighbours;
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
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
               const std::vector<FaceRulePoint>& points, const FaceNodes& nodes) {
  // Area vector (b - a) x (c - a) / 2: its length is the area, its direction the
  // outward normal.
  Eigen::Matrix3d corner;
  for (int j = 0; j < 3; ++j) {
    corner.col(j) = mesh.position_m.row(mesh.surface(face, j)).transpose();
  }
  const Eigen::Vector3d area_vector =
      0.5 * (corner.col(1) - corner.col(0)).cross(corner.col(2) - corner.col(0));
  const double area = area_vector.norm();
  const Eigen::Vector3d normal = area_vector / area;
  for (const FaceRulePoint& point : points) {
    for (int j = 0; j < 6; ++j) {
      // weight = psi_j(x_q) w_q A [m^2], the point's part of the integral of hat j.
      const double weight = point.hat[j] * point.area_share * area;
      if (weight == 0.0) {
        continue;
      }
      ContactNode& node = *nodes[static_cast<std::size_t>(j)];
      node.area_m2 += weight;
      node.normal += weight * normal;
      node.gap_points.push_back({corner * point.at, normal, weight});
      // Consistent load of a unit pressure with shape psi_j, inward: -integral of psi_j
      // N_a n. normalise() divides by the hat's area; the load is then that of 1 N.
      for (int a = 0; a < 6; ++a) {
        add_nodal_force(node, mesh.surface(face, a), -weight * point.shape[a] * normal);
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
  const std::vector<FaceRulePoint>& points = face_rule();
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

std::vector<std::int32_t> contact_mesh_nodes(const ContactSurface& surface,
                                             std::span<const std::int32_t> patch) {
  std::vector<std::int32_t> nodes;
  for (const std::int32_t v : patch) {
    for (const NodalForce& entry : node_of(surface, v).load) {
      nodes.push_back(entry.node);
    }
  }
  return nodes;
}

Eigen::VectorXd pressure_load_n(const ContactSurface& surface,
                                std::span<const std::int32_t> patch,
                                const Eigen::VectorXd& pressure_n) {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(3 * std::ssize(surface.of_mesh_node));
  for (std::size_t i = 0; i < patch.size(); ++i) {
    for (const NodalForce& entry :
         surface.node[static_cast<std::size_t>(patch[i])].load) {
      load.segment<3>(3 * Eigen::Index{entry.node}) +=
          pressure_n[static_cast<Eigen::Index>(i)] * entry.force;
    }
  }
  return load;
}

}  // namespace palpate
