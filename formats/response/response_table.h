// The responses of one tool at every node of a body, in flat arrays.
//
// Meaning (FORMAT.md): the body pushes the tool along the unit vector u of
// a node with force f(d); d = (delta - touch_offset) |n_out . u| for a tool at normal
// penetration delta, so that the integral of f over d is the work of the force vector.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "formats/response/compliance_table.h"
#include "formats/response/contact_table.h"
#include "formats/response/curve_view.h"
#include "formats/response/puncture.h"
#include "formats/response/relaxation.h"
#include "formats/response/tilt_line.h"
#include "formats/response/tool_shape.h"
#include "formats/response/viscoelasticity.h"

namespace palpate {

/// (rows x columns) in single precision, one row after the other.
using RowMajorMatrixF =
    Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

enum class ResponseOrigin : std::uint8_t {
  kNone = 0,          ///< outside the reachable part: no curve, zero force
  kSimulated = 1,     ///< solved at this node
  kInterpolated = 2,  ///< from solved neighbours
  kMeasured = 3,      ///< fitted to a measurement
};

/// Quality flags of a node's response, a bit each.
enum ResponseFlag : std::uint8_t {
  kFallingCurve = 1,     ///< force falls with depth somewhere (snap-through)
  kForceCapped = 2,      ///< computed up to the scene's force_max_n only
  kCoarseContact = 4,    ///< contact spans less than 1.5 node spacings to each side
  kErrorOverBudget = 8,  ///< error estimate exceeds the scene's accuracy budget
  kFailed = 16,          ///< the solve failed: no curve
  kExtrapolated = 32,    ///< interpolated from curves beyond their last sample
  kTruncatedPath = 64,   ///< ends early: solve stopped, or tool at a support
  /// A near-singular load path of the nonlinear solve: a step was cut, the contact
  /// stiffened, or the body was about to give way. Other equilibria may lie near.
  kNearSingular = 128,
};
constexpr std::uint8_t kAllResponseFlags = 255;
constexpr std::size_t kResponseFlags = 8;

/// One node's response as a simulation or a fit delivers it.
struct NodeResponse {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< [-] unit, force on the tool
  double direction_spread_rad =
      0.0;  ///< [rad] largest angle of the force to `direction`
  double touch_offset_m =
      0.0;  ///< [m] normal penetration at first touch; < 0 if concave
  std::vector<double> depth_m;  ///< (k) [m] along `direction`, from 0; empty for none
  std::vector<double> force_n;  ///< (k) [N] from 0
  /// (k) [-] unit, force on the tool; empty where `direction` tells enough
  std::vector<Eigen::Vector3d> sample_direction = {};
  std::optional<TiltLine> tilt = {};  ///< none: `direction` tells enough
  ContactTable contact = {};          ///< one row, or none
  double error_relative = 0.0;  ///< [-] error of force that force_difference() measures
  ResponseOrigin origin = ResponseOrigin::kNone;
  std::uint8_t flags = 0;
};

/// How well a tool's responses keep the accuracy budget, measured at places of the
/// surface that were solved better, to compare.
struct AccuracyRecord {
  double budget_relative = 0.0;  ///< [-] of force, as the scene asks; 0: no record
  /// [-] What estimates were multiplied by to give error_relative, so that it holds at
  /// 95 % of places (error_calibration.h); 0: not calibrated.
  double error_factor = 0.0;
  /// [-] The same in elements that have a node with kNearSingular; 0: none.
  double hard_error_factor = 0.0;
  /// [-] The share of places that error_relative holds for, as the number of checks and
  /// of failed ones tells (covered_share()); and beside nodes with kNearSingular. 0:
  /// unknown.
  double covered = 0.0;
  double hard_covered = 0.0;
  std::int64_t verified = 0;  ///< places behind the quantiles
  /// Of those: inside elements and on their edges, where the field of the nodes'
  /// responses is compared. 0: all are at nodes, and nothing is said of places between.
  std::int64_t between_nodes = 0;
  std::vector<double> quantile_level;  ///< (q) [-] [0, 1], increasing
  std::vector<double> error_relative;  ///< (q) [-] measured error at these levels
  /// (m) [-] (0, 1] of the largest depth, increasing; empty where nodes alone, or fewer
  /// than 19 places, were solved better.
  std::vector<double> depth_share = {};
  /// (m) [-] From that depth on the force at 95 % of places is within this share.
  std::vector<double> covering_relative = {};
};

/// Displacement of the surface under the tool, for drawing, at solved node node[j] and
/// normal penetration depth_m[j]. There vertex i moves by rows 3 i to 3 i + 2 of
/// basis * coefficient.row(j)^T [m]. Single precision; empty without rows.
struct DisplacementField {
  RowMajorMatrixF basis;           ///< (3 n x m) [-] modes, x y z of a vertex in turn
  RowMajorMatrixF coefficient;     ///< (k x m) [m]
  std::vector<std::int32_t> node;  ///< (k) the node that is pressed
  std::vector<double> depth_m;     ///< (k) [m] normal penetration
  std::vector<double> error_relative;  ///< (k) [-] what m modes miss, L2 over vertices
};

/// Responses of one tool: node i owns samples [sample_begin[i], sample_begin[i+1]).
struct ResponseTable {
  ToolShape tool;
  Points direction;                           ///< (n x 3) [-]
  std::vector<double> direction_spread_rad;   ///< (n) [rad]
  std::vector<double> touch_offset_m;         ///< (n) [m]
  std::vector<double> error_relative;         ///< (n) [-] stated error of force
  std::vector<double> friction;               ///< (n) [-]
  std::vector<double> presliding_m;           ///< (n) [m]
  std::vector<double> stiffness_max_n_per_m;  ///< (n) [N/m] largest slope of the curve
  std::vector<std::uint8_t> origin;           ///< (n) ResponseOrigin
  std::vector<std::uint8_t> flags;            ///< (n) ResponseFlag bits
  std::vector<std::int64_t> sample_begin;     ///< (n + 1)
  std::vector<double> depth_m;                ///< (s) [m]
  std::vector<double> force_n;                ///< (s) [N]
  std::vector<double> stiffness_n_per_m;      ///< (s) [N/m] Hermite slopes
  std::vector<double> energy_j;               ///< (s) [J]

  // Optional parts: empty where nobody filled them.
  /// (n) [-] found at places that are nearest to the node; NaN: at none
  std::vector<double> verified_error_relative;
  std::vector<std::int32_t> failure;        ///< (n) row of failure_reason; -1: none
  std::vector<std::string> failure_reason;  ///< one line each
  std::vector<std::int32_t> history;        ///< (n) row of history_text; -1: none
  /// One line each: what a node's solve tried after its first recipe, with reasons.
  std::vector<std::string> history_text;
  std::vector<double> force_errors_n;  ///< (s) [N] standard uncertainty of force
  /// (n + 1) Node i owns rows [begin[i], begin[i+1]) of sample_direction, none or one
  /// per sample.
  std::vector<std::int64_t> direction_begin;
  Points sample_direction;  ///< (q x 3) [-] unit direction, where it turns with depth
  Points tilt;              ///< (n x 3) [-] TiltLine; 0 without response
  Points tilt_by_depth_per_m;  ///< (n x 3) [1/m]
  AccuracyRecord accuracy;
  DisplacementField displacement;
  ResponseRelaxation relaxation;  ///< what holds showed; not rendered
  Viscoelasticity viscoelasticity;
  Puncture puncture;           ///< of a needle
  ContactTable contact;        ///< pressure and lateral stiffness
  ComplianceTable compliance;  ///< how several contacts couple

  [[nodiscard]] std::int64_t nodes() const noexcept {
    return static_cast<std::int64_t>(touch_offset_m.size());
  }

  /// The curve of a node; empty where its origin is kNone. Valid as long as the table.
  [[nodiscard]] CurveView curve(std::int64_t node) const noexcept;

  /// Largest depth of any curve [m]; 0 without curves.
  [[nodiscard]] double depth_max_m() const noexcept;
};

/// Builds a table from node responses: slopes, energies and largest slopes are made
/// here (ResponseCurve), falling curves are flagged. Tilts are kept where all responses
/// have one.
/// @throws InputError naming the node whose samples or direction are not valid.
[[nodiscard]] ResponseTable make_table(const ToolShape& tool,
                                       const std::vector<NodeResponse>& responses);

}  // namespace palpate
