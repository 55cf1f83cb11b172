// The rigid tool that presses into a body.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

inline constexpr std::array<std::string_view, 5> kToolKinds{"sphere", "flat-punch",
                                                            "cone", "capsule", "mesh"};

constexpr std::int64_t kMostContacts = 64;  ///< spheres of a tool

/// Spheres by which a rigid tool touches at several places at once.
struct ContactSet {
  Points point_m = {};                ///< (c x 3) [m] centres, in the tool's frame
  std::vector<double> radius_m = {};  ///< (c) [m] > 0

  [[nodiscard]] bool empty() const noexcept { return radius_m.empty(); }
};

/// What touches the body: rigid, convex, in its own frame with +z from tip to handle.
/// Its pose is its reference point, the frame's origin. The origin is a sphere's
/// centre, the centre of a punch's flat face or the tip of a (rounded) cone. Of a
/// capsule the origin is the centre of the lower hemisphere, of a mesh the mesh's own
/// origin. Lengths that a kind does not have are 0.
struct ToolShape {
  std::string name;             ///< as the scene names it
  std::string kind = "sphere";  ///< one of kToolKinds
  double radius_m = 0.0;        ///< [m] (0, inf) sphere, flat-punch, capsule
  double friction = 0.0;        ///< [-] [0, 10] Coulomb coefficient, tangential plane
  double presliding_m =
      0.0;  ///< [m] [0, inf) delta_L, displacement at which sliding starts
  /// Of a scene: presliding follows from the lateral stiffness of the presses.
  bool presliding_computed = false;
  double edge_radius_m = 0.0;   ///< [m] [0, radius) flat-punch
  double half_angle_rad = 0.0;  ///< [rad] (0, pi/2) cone, between axis and flank
  double tip_radius_m = 0.0;    ///< [m] [0, inf) cone
  double length_m =
      0.0;             ///< [m] capsule: of its axis (0, inf); cone: height, 0: endless
  SurfaceMesh mesh{};  ///< kind mesh: closed, convex, outside out
  /// [-] unit, from the tip to the handle, in the world. None: along the outward normal
  /// of the vertex that is pressed, as laboratory indenters stand.
  std::optional<Eigen::Vector3d> axis = std::nullopt;
  bool sticking = false;  ///< else the contact is without friction while pressing
  /// A sphere that stands for several (contact_set.h); one touches at its own place.
  ContactSet contact = {};
};

/// @throws InputError naming the value that is out of range, or that the kind does not
/// have.
void check(const ToolShape& tool);

/// check() of all but the mesh, which is read later than the rest.
void check_without_mesh(const ToolShape& tool);

/// In a few words: "cone of half-angle 30 deg, tip radius 0.1 mm, sticking".
[[nodiscard]] std::string describe(const ToolShape& tool);

}  // namespace palpate
