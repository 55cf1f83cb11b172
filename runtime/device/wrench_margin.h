// Whether a device can render a tool with several contacts: the sampling bound in six
// axes.
#pragma once

#include <string>

#include <Eigen/Core>

namespace palpate {

/// What turns with a tool, and how stiff its contacts are together.
struct ContactStiffness {
  Eigen::MatrixX3d lever_m;       ///< (c x 3) [m] contacts from the reference point
  Eigen::MatrixXd n_per_m;        ///< (c x c) [N/m] df_i/dd_j, symmetric
  double friction_n_per_m = 0.0;  ///< [N/m] >= 0 k_t of each contact's spring
};

struct WrenchMargin {
  /// [-] Largest eigenvalue of (T/2 + delay) B^-1/2 K B^-1/2; rendered up to 1.
  double share = 0.0;
  double angular_share = 0.0;          ///< [-] of it, of the axis' energy, in turning
  double stiffness_n_per_m = 0.0;      ///< [N/m] largest of the translations alone
  double stiffness_n_m_per_rad = 0.0;  ///< [N m/rad] largest of the turns alone
};

/// With the contacts' normals all along n, J_i = (n, r_i x n). The stiffness is
/// K = sum_ij J_i^T K_ij J_j, with the springs of friction across n. Held forces give a
/// hand no energy where B - (T/2 + delay) K is positive semidefinite. The sources are
/// Colgate & Schenkel 1997 in every direction of six axes; Diolaiti et al. 2006 for the
/// delay. The worst n of those along the axes and diagonals of space, as the tool may
/// turn.
/// @param angular_n_m_s [N m s] viscous damping of turns; 0: not known, translations
/// alone are checked. @param linear_n_s_per_m > 0.
[[nodiscard]] WrenchMargin wrench_margin(const ContactStiffness& contacts,
                                         double linear_n_s_per_m, double angular_n_m_s,
                                         double hold_s, double delay_s);

/// Why it cannot be rendered; empty if it can. One line.
[[nodiscard]] std::string why_not_renderable(const WrenchMargin& margin,
                                             double linear_n_s_per_m,
                                             double angular_n_m_s);

}  // namespace palpate
