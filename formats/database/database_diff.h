// How far two databases of one body are apart in force.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "formats/response/force_difference.h"

namespace palpate {

/// Forces of two curves over the tool positions that both have.
struct CurveDifference {
  double depth_m = 0.0;    ///< [m] from the first touch of either to the end of either
  double largest_n = 0.0;  ///< [N] largest difference |F - F'| on the Gauss points
  double rms_n = 0.0;      ///< [N] root mean square over the common depth
  double force_rms_n = 0.0;  ///< [N] of the first curve there
};

/// Forces are vectors. The mean is an integral between the samples of both, four Gauss
/// points each. The integral is exact to rounding where both point the same way at all
/// depths, because magnitudes are cubics. Zero without a common depth.
[[nodiscard]] CurveDifference difference(const PlacedCurve& a, const PlacedCurve& b);

struct NodeDifference {
  std::int64_t node = 0;
  CurveDifference curve;
  double relative_rms = 0.0;      ///< [-] rms over the first curve's rms; 0 for 0/0
  double direction_rad = 0.0;     ///< [rad] angle between the directions
  double largest_relative = 0.0;  ///< [-] what a stated error bounds: force_difference
};

/// How the first database's stated errors (`error_relative`) compare with what the
/// second, computed better, finds.
struct StatedErrors {
  double covered = 0.0;            ///< [-] share of nodes that are within theirs
  double stated_over_found = 0.0;  ///< [-] median
  double found_median = 0.0;       ///< [-]
  double found_p95 = 0.0;          ///< [-]
};

struct ToolDifference {
  std::string tool;
  std::int64_t compared = 0;          ///< nodes with a curve in both
  std::int64_t only_first = 0;        ///< nodes with a curve in the first alone
  std::int64_t only_second = 0;       ///< ... in the second alone
  double largest_n = 0.0;             ///< [N] of any node
  double rms_n = 0.0;                 ///< [N] over all compared nodes
  double largest_relative_rms = 0.0;  ///< [-] of any node
  double largest_depth_m = 0.0;       ///< [m] largest difference of largest depths
  double largest_direction_rad = 0.0;
  double largest_relaxation = 0.0;  ///< [-] of F(0) while held; unstated: none relaxes
  bool same_memory = true;    ///< sites, bundles, of which press curves are, yielding
  bool same_puncture = true;  ///< what a needle breaks, cuts and rubs against
  double largest_compliance = 0.0;  ///< [-] of the first's largest; 1: one has none
  double largest_contact = 0.0;     ///< [-] of pressures' radii, lateral stiffnesses
  StatedErrors stated;
  std::vector<NodeDifference> worst;  ///< by relative rms, the worst first

  /// Whether no force differs by more than this part of the node's own, and no node has
  /// a response in one file only. Curves must end together and relax alike, and
  /// punctures are the same.
  [[nodiscard]] bool agrees(double tolerance_relative) const;
};

/// Compares tools that both have, in the order of the first.
/// @param worst how many nodes to list per tool.
/// @throws InputError if the bodies differ, or have no tool in common.
[[nodiscard]] std::vector<ToolDifference> difference(const ResponseDatabase& a,
                                                     const ResponseDatabase& b,
                                                     std::size_t worst);

/// @throws InputError saying where two bodies differ: nodes, triangles or a position.
void require_same_body(const ResponseDatabase& a, const ResponseDatabase& b);

}  // namespace palpate
