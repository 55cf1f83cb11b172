// One node pressed by a rigid tool into a body of nonlinear material.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "precompute/contact/contact_surface.h"
#include "precompute/contact/equilibrium.h"
#include "precompute/contact/surface_compliance.h"
#include "precompute/fem/quadratic_mesh.h"
#include "precompute/material/material.h"

namespace palpate {

/// What is pressed; all of it must outlive the computation.
struct NonlinearBody {
  const QuadraticMesh& mesh;
  std::span<const Material> material;  ///< by region
  const Supports& supports;
  const ContactSurface& surface;
  /// Of the body at rest, both or none: where conjugate gradients are slow, tangents
  /// are factored in this factor's order.
  const CholeskyFactor* factor = nullptr;
  const Stiffness* stiffness = nullptr;
};

/// One step of the path, and where the linear body stands there.
struct PressStep {
  double penetration_m = 0.0;
  PlacedTool tool;
  Eigen::VectorXd linear_pressure_n;  ///< (n_patch) [N]
  /// Passed over as long as the path is easy to follow.
  bool only_if_hard = false;
};

struct NonlinearOptions {
  /// [-] Tets whose linear displacement gradient at the largest depth stays below it
  /// keep their rest stiffness, but for laws with a kink (has_kink).
  double near_gradient = 0.05;
  /// [-] Largest energy that the linear tets may miss, over the stored energy, at the
  /// largest depth. If the linear solution misses more, near_gradient is divided by 3,
  /// then by 9. If the nonlinear solution still misses more, next() repeats the press.
  double far_excess_max = 0.005;
  /// [-] Largest force error by interpolation between solved depths. If it is larger,
  /// next() solves every depth; 0: every depth is solved from the start.
  double depth_error_max = 0.015;
  /// [-] Compression of the contact's penalty springs that is tolerated, over the depth
  /// since the first touch.
  double give_relative = 0.0;
  /// [-] Contact springs over the contact nodes' own rest stiffness.
  double spring_factor = 2.0;
  bool sticking = false;
  /// Newton steps of a path step that passes over others. With more Newton steps the
  /// path counts as hard: it goes on in stiff contact, with the steps that were passed
  /// over. Usual are 10.
  int newton_easy = 20;
  /// Stiff contact from the first step on; else it is tried where a step fails.
  bool stiff = false;
  int bisections_max = 4;  ///< of a step that fails
  /// A press fails with more Newton steps than this for each depth of the path, plus
  /// equilibrium.newton_max for one depth that fails. Usual are 10 a depth.
  int newton_per_depth = 20;
  EquilibriumOptions equilibrium = {};
};

struct NonlinearSample {
  std::size_t step = 0;  ///< of the path's
  double penetration_m = 0.0;
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();  ///< on the tool
  Eigen::Vector3d moment_nm =
      Eigen::Vector3d::Zero();     ///< on the tool, about the origin
  double energy_j = 0.0;           ///< stored in the body
  double contact_area_m2 = 0.0;    ///< of the rest surface
  double largest_overlap_m = 0.0;  ///< averaged over a contact node's hat
  double smallest_jacobian = 1.0;  ///< [-] det F
  int newton = 0;
  int gradients = 0;
  int lagrange = 0;
  double multiplier_relative = 0.0;  ///< [-] pressures that springs carry still
  double give_m = 0.0;               ///< [m] by those: spring_give_m
};

struct NonlinearIndentation {
  std::vector<NonlinearSample> sample;  ///< as far as it came
  std::string failure;                  ///< empty where every step converged
  /// Newton steps and gradients of all attempts, also of those that failed.
  std::int64_t newton = 0;
  std::int64_t gradients = 0;
  /// A step was cut, the contact stiffened, or the tangent was indefinite where
  /// Newton's method ended: other equilibria may lie near.
  bool near_singular = false;
  /// [-] far_excess_j over the energy, at the end; at most 1
  double far_excess_relative = 0.0;
  double near_gradient = 0.0;  ///< [-] of near tets: NonlinearOptions' or less
  Eigen::Index near_tets = 0;
  Eigen::Index near_nodes = 0;
  std::vector<Eigen::Index> near_tet;  ///< of the mesh, ascending; linear laws too
  NearState state;                     ///< at the last sample, over `near_dof`
  std::vector<std::int64_t> near_dof;
  Eigen::VectorXd pressure_n;  ///< (n_patch) [N] at the last sample
  [[nodiscard]] bool converged() const { return failure.empty(); }
};

/// Follows the path through its steps, of growing penetration. A step that does not
/// converge is cut in halves. If the step passes over other steps, these are taken
/// instead of halves. A step that fails for good ends the path. Contact may be lost on
/// the way and found again: a depth without contact has no force.
/// @param patch contact nodes, as for indent().
/// @param compliance (n_patch x n_patch) [m/N] among them.
/// @param touch_m penetration at first touch [m], below the steps' penetrations.
/// Nothing is deformed yet; touch_m is negative in a concave place.
/// @param place the tool at a penetration, for cut steps.
[[nodiscard]] NonlinearIndentation indent_nonlinear(
    const NonlinearBody& body, std::span<const std::int32_t> patch,
    const Eigen::MatrixXd& compliance, double touch_m, std::span<const PressStep> steps,
    const std::function<PlacedTool(double penetration_m)>& place,
    const RestSolve& solve, const NonlinearOptions& options);

}  // namespace palpate
