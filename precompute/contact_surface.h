// The discretised contact: where pressure may act on a quadratic surface, what it
// loads, and how far it is from the tool.
//
// Pressure is piecewise linear and continuous on the four sub-triangles of every
// quadratic face, with one value per surface node (corner or edge middle): hat
// functions psi_v. The gap is averaged with the same hats, so that the condition
// "average gap >= 0, pressure
// >= 0, one of them zero" is the stationarity of an energy (mortar method; compare
// Wohlmuth, Acta Numerica 2011, section 3): compliance is symmetric, and the force on
// the tool is the derivative of the stored energy with the tool's position.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "precompute/quadratic_mesh.h"

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

[[nodiscard]] ContactSurface make_contact_surface(const QuadraticMesh& mesh);

/// A rigid sphere that is pressed along -`press`.
struct PressedSphere {
  Eigen::Vector3d centre_m;  ///< [m]
  Eigen::Vector3d press;  ///< [-] unit, from the body towards where the tool came from
  double radius_m = 0.0;  ///< [m]
};

/// How far a surface point can move out along its normal before it meets the sphere,
/// and the derivative with the sphere's centre.
struct Gap {
  double distance_m = 0.0;    ///< [m] negative where the sphere reaches in
  Eigen::Vector3d by_centre;  ///< [-] d(distance)/d(centre)
};

/// (press . n) times the height of the sphere's near half above the point, seen along
/// `press`: -b - sqrt(R^2 - s^2), with r = p - centre, b = press.r, s = |r - b press|.
/// To first order in the gap this is the distance along the normal n, and its
/// derivative with the centre is n where the sphere touches. Beyond s = 0.95 R the
/// profile goes on with its slope there, so that the gap is C1 everywhere and the
/// equator's wall does not enter. Zero where the surface faces away.
[[nodiscard]] Gap sphere_gap(const Eigen::Vector3d& p_m, const Eigen::Vector3d& normal,
                             const PressedSphere& sphere);

/// Average of sphere_gap over a contact node's hat.
[[nodiscard]] Gap average_gap(const ContactNode& node, const PressedSphere& sphere);

}  // namespace palpate
