// Pressure over a tool's face: what a grid of taxels under it would read.
//
// The tool stands at a place, as a static press. Nodes of the triangle below count by
// area coordinates w_j and their normal forces N_j at their own depths:
//
//   N = sum w_j N_j,   c, M, m = sum w_j N_j (c_j, M_j, m_j) / N
//
// and contact_table.h's ellipse is the pressure. It is summed over points of every
// taxel, and scaled. So the taxels' forces sum to N, less what lies beside the grid.
#pragma once

#include <Eigen/Core>

#include "formats/mesh/surface_search.h"
#include "formats/response/response_table.h"

namespace palpate {

inline constexpr int kMostTaxels = 1000;  ///< to a side

/// Square taxels in the plane across the surface's normal, their middle on the line of
/// the tool's reference point. Columns go along x, rows along y of tangent_frame().
struct TaxelGrid {
  int rows = 16;
  int columns = 16;
  double pitch_m = 0.001;  ///< [m] > 0
};

struct Taxels {
  Eigen::MatrixXd pressure_pa;  ///< (rows x columns) [Pa] mean over each taxel
  ContactPressure contact;      ///< the ellipse, from the same middle
  double beside_n = 0.0;        ///< [N] of contact.normal_n that no taxel bears
  /// [-] stated error of the contact's radius; pressures are off by twice as much
  double error_relative = 0.0;
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();  ///< [m] on the surface
  Eigen::Vector3d outward = Eigen::Vector3d::UnitZ();  ///< [-] unit normal there
};

/// Where the tool's reference point stands, pressed along the normal of the surface's
/// point that is nearest. @param at_m [m] finite. @param depth_m [m] normal
/// penetration.
[[nodiscard]] Eigen::Vector3d pressed_position_m(
    const SurfaceMesh& mesh, const Points& normal, const SurfaceSearch& search,
    const ToolShape& tool, const Eigen::Vector3d& at_m, double depth_m);

/// @param search over the mesh. @param normal (n x 3) [-] outward of its nodes.
/// @param table with pressures. @param position_m [m] of the tool's reference point.
/// @throws InputError for a table without pressures, a grid that is none, or a position
/// that is not finite. Without contact all pressures are 0.
[[nodiscard]] Taxels taxels_at(const SurfaceMesh& mesh, const Points& normal,
                               const SurfaceSearch& search, const ResponseTable& table,
                               const Eigen::Vector3d& position_m,
                               const TaxelGrid& grid);

}  // namespace palpate
