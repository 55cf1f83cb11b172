// The discretised contact: where pressure may act on a quadratic surface, what it
// loads, and where its distance to a tool (contact_gap.h) is averaged.
//
// Pressure is piecewise linear and continuous on the four sub-triangles of every
// quadratic face. Pressure has one value per surface node (corner or edge middle): hat
// functions psi_v. The gap is averaged with the same hats. So the condition "average
// gap >= 0, pressure >= 0, one of them zero" is the stationarity of an energy. This is
// the mortar method (compare Wohlmuth, Acta Numerica 2011, section 3). Compliance is
// symmetric, and the force on the tool is the derivative of the stored energy with the
// tool's position.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "precompute/fem/quadratic_mesh.h"

namespace palpate {

/// One point of a hat's average: where, along which face normal, with what weight.
struct GapPoint {
  Eigen::Vector3d position_m;  ///< [m]
  Eigen::Vector3d normal;      ///< [-] outward normal of the face
  double weight = 0.0;         ///< [-] weights of one contact node sum to 1
};

/// A force entry of a contact node's unit load.
struct NodalForce {
  std::int32_t node = 0;  ///< of the quadratic mesh
  Eigen::Vector3d
      force;  ///< [-] per newton of pressure force, along the inward normals
};

struct ContactNode {
  std::int32_t mesh_node = 0;  ///< node of the quadratic mesh
  Eigen::Vector3d position_m;  ///< [m]
  Eigen::Vector3d normal;      ///< [-] outward unit, average over the hat
  bool is_corner = false;      ///< of a tetrahedron, else the middle of an edge
  double area_m2 = 0.0;        ///< [m^2] integral of the hat
  std::vector<GapPoint> gap_points;
  std::vector<NodalForce> load;          ///< consistent nodal forces of 1 N
  std::vector<std::int32_t> neighbours;  ///< contact nodes sharing a sub-triangle
};

struct ContactSurface {
  std::vector<ContactNode> node;
  std::vector<std::int32_t> of_mesh_node;  ///< (n_mesh_nodes) contact node, or -1
};

[[nodiscard]] inline const ContactNode& node_of(const ContactSurface& surface,
                                                std::int32_t v) {
  return surface.node[static_cast<std::size_t>(v)];
}

[[nodiscard]] ContactSurface make_contact_surface(const QuadraticMesh& mesh);

/// Nodes of every face that carries one of the patch's hats; some more than once.
[[nodiscard]] std::vector<std::int32_t> contact_mesh_nodes(
    const ContactSurface& surface, std::span<const std::int32_t> patch);

/// (3 n_mesh_nodes) [N] on the mesh's nodes, of pressures on a patch's hats.
/// @param pressure_n (n_patch) [N].
[[nodiscard]] Eigen::VectorXd pressure_load_n(const ContactSurface& surface,
                                              std::span<const std::int32_t> patch,
                                              const Eigen::VectorXd& pressure_n);

}  // namespace palpate
