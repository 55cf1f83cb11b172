// One node pressed by a rigid sphere along its normal: force vector against depth.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/response_table.h"
#include "precompute/contact_surface.h"
#include "precompute/surface_compliance.h"

namespace palpate {

struct IndentationPath {
  Eigen::Vector3d vertex_m;  ///< [m] the node
  Eigen::Vector3d outward;   ///< [-] unit normal of the body there
  double radius_m = 0.0;     ///< [m] the sphere's
  double depth_max_m = 0.0;  ///< [m] largest normal penetration
  double force_max_n = 0.0;  ///< [N] the path ends where the force passes it
  int samples = 20;          ///< depths after the first touch, closer together near it
};

/// State at one normal penetration delta: the sphere's centre is at
/// vertex + (radius - delta) outward.
struct IndentationSample {
  double penetration_m = 0.0;  ///< [m] delta; the first sample is the first touch
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();  ///< [N] on the tool
  double energy_j = 0.0;                              ///< [J] stored in the body
  double contact_radius_m = 0.0;  ///< [m] of a disc with the area in contact
  double coarse_force_n = 0.0;    ///< [N] with pressure at the faces' corners only
};

struct Indentation {
  std::vector<IndentationSample> sample;
  double node_spacing_m = 0.0;  ///< [m] contact nodes' mean distance around the vertex
  int iterations = 0;           ///< of the complementarity solver, all depths
  bool converged = true;
  bool reached_patch_edge =
      false;                  ///< contact grew to the last node that was considered
  bool force_capped = false;  ///< ended at force_max_n
};

/// Contact nodes that the tool may touch: joined to `start` over the surface, within
/// `radius_m` of it, facing the same way, and not held.
[[nodiscard]] std::vector<std::int32_t> contact_patch(const ContactSurface& surface,
                                                      const Supports& supports,
                                                      std::int32_t start,
                                                      double radius_m);

/// Radius of the patch for contact_patch [m]: what a sphere pressed depth_max_m into a
/// flat elastic surface shadows, and two node spacings more.
[[nodiscard]] double patch_radius_m(double tool_radius_m, double depth_max_m,
                                    double node_spacing_m);

/// Presses along the path. The force on the tool is the derivative of the stored energy
/// with the tool's position, so that the work along the path is the stored energy.
/// @param patch from contact_patch. An empty patch gives an empty indentation.
[[nodiscard]] Indentation indent(const ContactSurface& surface,
                                 const SurfaceCompliance& compliance,
                                 std::span<const std::int32_t> patch,
                                 const IndentationPath& path);

/// The stored form: |F| against displacement along one direction, the mean of the force
/// along the path. Origin kSimulated, or kNone where the tool met nothing. The
/// estimated error is the rms relative difference that pressure on a mesh twice as
/// coarse makes over the deeper half of the path (a
/// measure of order, not a bound: see the tests on Hertz's problem).
[[nodiscard]] NodeResponse to_response(const Indentation& indentation,
                                       const IndentationPath& path,
                                       double force_relative_budget);

}  // namespace palpate
