// One node pressed by a rigid tool along its normal: force vector against depth.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "precompute/contact/contact_surface.h"
#include "precompute/contact/surface_compliance.h"
#include "precompute/contact/tool_surface.h"

namespace palpate {

struct IndentationPath {
  Eigen::Vector3d vertex_m;  ///< [m] the node
  Eigen::Vector3d outward;   ///< [-] unit normal of the body there
  std::shared_ptr<const ToolSurface> tool;
  double depth_max_m = 0.0;  ///< [m] largest normal penetration
  double force_max_n = 0.0;  ///< [N] the path ends where the force passes it
  int samples = 20;          ///< depths after the first touch, closer together near it
};

/// The tool at a normal penetration.
[[nodiscard]] inline PlacedTool tool_at(const IndentationPath& path,
                                        double penetration_m) {
  return place_on_path(*path.tool, path.vertex_m, path.outward, penetration_m);
}

/// State at one normal penetration delta (place_on_path).
struct IndentationSample {
  double penetration_m = 0.0;  ///< [m] delta; the first sample is the first touch
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();  ///< [N] on the tool
  double energy_j = 0.0;                              ///< [J] stored in the body
  double contact_radius_m = 0.0;    ///< [m] of a disc with the area in contact
  double coarse_force_n = 0.0;      ///< [N] with pressure at the faces' corners only
  Eigen::VectorXd pressure_n = {};  ///< (n_patch) [N] contact forces
};

/// How the contact bears at one penetration, in the frame of the path's normal
/// (tangent_frame). Of the linear press, also where a nonlinear one replaced its
/// forces.
struct PatchState {
  double penetration_m = 0.0;
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();   ///< [m] of the pressure
  Eigen::Matrix2d moment_m2 = Eigen::Matrix2d::Zero();  ///< [m^2] about the centre
  double exponent = 0.5;                                ///< [-] m of contact_table.h
  double spacing_ratio = 0.0;  ///< [-] node spacing over the contact's radius
  /// [-] K_t over the normal stiffness of the same nodes; 0: not asked for.
  Eigen::Matrix2d lateral = Eigen::Matrix2d::Zero();
  double by_tangent = 0.0;  ///< [-] what a nonlinear body's tangent changed of it
};

struct Indentation {
  std::vector<IndentationSample> sample;
  std::vector<PatchState> contact = {};  ///< of growing penetration
  double node_spacing_m = 0.0;  ///< [m] contact nodes' mean distance around the vertex
  /// [-] of the force at the last depth, by what is left out of the body around
  double exterior_error_relative = 0.0;
  /// [-] of the force, by depths that were not solved but interpolated
  double path_error = 0.0;
  /// [-] of the force, by the mesh, where a press on a coarser one tells it; else 0
  double mesh_error = 0.0;
  /// [-] What the laws' energy adds to the linear body's at half of its displacements
  /// at the last depth, over that; where nobody asked, 0.
  double nonlinearity = 0.0;
  /// The nonlinear path was cut, stiffened or met a body about to give way.
  bool near_singular = false;
  int iterations = 0;  ///< of the complementarity solver, all depths
  bool converged = true;
  /// [-] Of the force at the last depth, what bears on the last nodes that were
  /// considered: as much again may bear beyond them.
  double edge_share = 0.0;
  bool force_capped = false;  ///< ended at force_max_n
  /// It ends below force_max_n, because the linear press that it follows has ended.
  bool ends_early = false;
  /// The tool also meets a part of the body whose contact is not in the force
  /// (other_contact.h).
  bool reaches_elsewhere = false;
};

/// Contact nodes that the tool may touch. They are joined to `start` over the surface,
/// within `radius_m` of `start`, and not held. They face the tool: their normals are
/// within 84 degrees of `outward`. A node that faces away is no obstacle to the press
/// along -outward. Its gap would neither close nor carry force on the tool.
[[nodiscard]] std::vector<std::int32_t> contact_patch(const ContactSurface& surface,
                                                      const Supports& supports,
                                                      std::int32_t start,
                                                      const Eigen::Vector3d& outward,
                                                      double radius_m);

/// Radius of the patch for contact_patch [m]: the tool's shadow radius and two node
/// spacings more. The shadow is that of the path's tool, pressed to its largest depth
/// into a flat elastic surface (shadow_radius_m at 1.44 times the depth). NaN where the
/// tool cannot be placed.
[[nodiscard]] double patch_radius_m(const IndentationPath& path, double node_spacing_m);

/// Presses along the path. The force on the tool is the derivative of the stored energy
/// with the tool's position. The work along the path is therefore the stored energy.
/// @param compliance with the columns of the patch.
/// @param patch from contact_patch. An empty patch gives an empty indentation.
[[nodiscard]] Indentation indent(const ContactSurface& surface,
                                 const SurfaceCompliance& compliance,
                                 std::span<const std::int32_t> patch,
                                 const IndentationPath& path);

/// Whether all numbers of a press are finite and its penetrations grow: the end of a
/// sentence that says what is not, or empty.
[[nodiscard]] std::string broken_rule(const Indentation& indentation);

}  // namespace palpate
