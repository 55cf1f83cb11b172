// One node pressed as a build presses it, with all that is known of the node. The
// detail holds the cost of every depth, the deformed body, and the checks of its
// balance.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "formats/scene/scene.h"
#include "precompute/body/meshed_body.h"
#include "precompute/body/scene_body.h"
#include "precompute/press/node_press.h"
#include "precompute/process/progress.h"

namespace palpate {

struct DepthDetail {
  std::int64_t newton = 0;         ///< steps; 0 where it was not solved nonlinear
  std::int64_t gradients = 0;      ///< conjugate gradients, one solve each
  double smallest_jacobian = 1.0;  ///< [-] det F of the near tets; of all if linear
};

/// The body where it was solved last.
struct DeformedBody {
  Eigen::VectorXd displacement_m;  ///< (3 n_nodes)
  /// (n_tets) 1 where the tet follows its law, 0 where it keeps its rest stiffness.
  std::vector<char> near;
  double penetration_m = 0.0;
};

/// Figures that vanish in an exact solution [-]; NaN where there is nothing to compare.
///
/// Balance is that of the discrete body. Tets near the tool follow their law. Far tets
/// (and all tets of a linear press) have their rest stiffness, so that their forces are
/// in balance about the rest position. What follows from that alone is kept apart as
/// `theory`.
struct BalanceChecks {
  /// |integral of F.n_out over the penetration - stored energy| / stored energy; the
  /// integral is that of the stored curve (response_curve.h).
  double work = std::numeric_limits<double>::quiet_NaN();
  /// |supports + contact| / |contact|: forces of held nodes and of foundations against
  /// that on the tool; in a linear press, against the pressure on the body.
  double force = std::numeric_limits<double>::quiet_NaN();
  /// The same of moments about the vertex, over force times the body's extent.
  double moment = std::numeric_limits<double>::quiet_NaN();
  /// Linear press: |force on the tool + pressure| / |force|; the linear contact presses
  /// along the rest surface's normals, the tool's own normals differ.
  double theory_force = 0.0;
  /// Moment that forces of far tets have about their deformed positions, over force
  /// times extent.
  double theory_moment = 0.0;
};

struct NodeDetail {
  PressedNode pressed;
  BodyModel model;
  std::vector<DepthDetail> depth;  ///< as pressed.indentation.sample
  DeformedBody body;
  BalanceChecks checks;
};

/// The checks of a press. The balance of forces and moments needs a contact whose
/// pressure does not load held nodes directly: else NaN.
[[nodiscard]] BalanceChecks check_balance(const Scene& scene, const BodyModel& model,
                                          const PressedNode& pressed,
                                          const DeformedBody& body);

/// Presses one vertex as a build solves it: on the mesh of its group, with the same
/// options, at the same depths. A press that does not suffice is repeated as in a
/// build. The forces are those of a build to the last bit, with two exceptions. A build
/// interpolates at some nodes, and presses again a linear node that its shared mesh is
/// too coarse for.
/// @param options if given, every depth is solved with these, but for sticking, which
/// is the tool's.
/// @throws InputError if the vertex does not exist or is held, NumericalError if
/// nothing was solved.
[[nodiscard]] NodeDetail press_in_detail(const Scene& scene, const BodySource& body,
                                         const SharedTool& tool, std::int64_t vertex,
                                         const std::optional<NonlinearOptions>& options,
                                         Progress& progress);

/// The vertex nearest to a point [m].
[[nodiscard]] std::int64_t nearest_vertex(const SurfaceMesh& surface,
                                          const Eigen::Vector3d& point_m);

}  // namespace palpate
