// How right forces of several contacts are that follow from curves of single ones and
// the table of compliance: against presses that are solved jointly.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/response/compliance_table.h"
#include "formats/response/curve_view.h"
#include "formats/scene/scene.h"
#include "precompute/body/meshed_body.h"
#include "precompute/body/scene_body.h"
#include "precompute/press/node_press.h"
#include "precompute/process/progress.h"

namespace palpate {

/// Forces f_i(delta_i) [N] of contacts with delta_i + sum_{j != i} C_ij f_j = depth_i,
/// by Newton's method; C's diagonal is not read.
/// @throws NumericalError where it does not converge.
[[nodiscard]] Eigen::VectorXd coupled_forces_n(
    std::span<const CurveView> curve, const Eigen::VectorXd& depth_m,
    const Eigen::MatrixXd& compliance_m_per_n);

/// Contacts pressed at once, all on one model of the linear body.
struct JointPress {
  std::vector<std::int32_t> vertex;
  Eigen::VectorXd joint_n;     ///< solved together
  Eigen::VectorXd alone_n;     ///< each by its own curve: not coupled
  Eigen::VectorXd by_table_n;  ///< curves coupled by the table
  Eigen::VectorXd by_spot_n;   ///< curves coupled by exact compliances of contact spots
};

/// Presses vertices at once with tools alike: one complementarity problem, every
/// contact node's gap that to the nearest of the tools.
/// @param depth_share (n) [-] (0, 1] of the way from a contact's first touch to its
/// largest depth.
/// @throws NumericalError where a vertex cannot be pressed alone, or nothing converges.
[[nodiscard]] JointPress press_jointly(const Scene& scene, const BodySource& body,
                                       const BodyModel& model, const SharedTool& tool,
                                       std::span<const std::int32_t> vertices,
                                       const Eigen::VectorXd& depth_share,
                                       const ComplianceTable& coupling);

/// Errors of force over the largest force of their set [-], all contacts of all sets,
/// ascending.
struct CouplingErrors {
  std::size_t contacts = 0;  ///< of a set
  std::size_t sets = 0;
  std::vector<double> alone;
  std::vector<double> by_table;
  std::vector<double> by_spot;
};

struct CouplingStudy {
  std::vector<CouplingErrors> by_count;  ///< as JointOptions::contacts
  std::size_t left_out = 0;              ///< sets that could not be meshed or pressed
  /// Of each set the largest error by table, of any of its forces; ascending.
  std::vector<double> worst_by_table;
};

struct JointOptions {
  std::size_t sets = 50;                          ///< > 0
  std::vector<std::size_t> contacts = {2, 3, 4};  ///< of a set, ascending
  std::uint64_t seed = 1;
};

/// How many sets a build of the scene presses for each tool that couples, to measure
/// its table's error. Twice as many as checks of single presses, for errors of sets
/// have a heavier tail. 0 where these sets are too few to state an error.
[[nodiscard]] std::size_t sets_of_build(const Scene& scene);

/// Presses sets of vertices jointly, on meshes made for each set. Vertices of a set are
/// 1.8 contact radii apart or more, and within 7 contact radii of the first. Depths are
/// half of the largest depth or more. A set that cannot be meshed or pressed is left
/// out, and counted.
/// @param vertices that are pressed. @param coupling of the scene.
[[nodiscard]] CouplingStudy coupling_errors(const Scene& scene, const BodySource& body,
                                            const SharedTool& tool,
                                            std::span<const std::int32_t> vertices,
                                            const ComplianceTable& coupling,
                                            const JointOptions& options,
                                            Progress& progress);

}  // namespace palpate
