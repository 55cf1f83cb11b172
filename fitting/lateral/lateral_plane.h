// A contact that is moved in two directions: its tangential stiffness as a tensor.
//
//   q = sum_e w_e K s_e,   |K s_e| <= rho_e S n,   ds_e = du while it sticks
//
// Symbols: q tangential force (2) [N], K symmetric stiffness (2 x 2) [N/m]. s_e is the
// stretch (2) [m] of slip element e, w_e its weight, rho_e its share of S. S is the
// sliding force [N], n the normal force over its mean, u the displacement (2) [m]. An
// element whose force is beyond its limit slides back along its own force. So does the
// runtime's FrictionSpring where K is the same in all directions. One element is a
// sharp slip. kPlaneElements of rho = 3/2 (1 - y^2), y even over [0, 1], are partial
// slip (contact_law.h).
#pragma once

#include <string>
#include <vector>

#include "fitting/curve/frame_compliance.h"
#include "fitting/lateral/contact_law.h"
#include "fitting/lateral/lateral_path.h"
#include "fitting/numerics/interval_estimate.h"

namespace palpate {

struct PlaneFit {
  std::string name;
  ContactLaw law = ContactLaw::kSharpSlip;
  double deviance = 0.0;  ///< -2 log of how much less likely the other law is
  double depth_m = 0.0, normal_n = 0.0;
  IntervalEstimate xx_n_per_m, xy_n_per_m,
      yy_n_per_m;  ///< K in the columns' directions
  IntervalEstimate slip_force_n, friction;
  IntervalEstimate presliding_m;  ///< S over the mean of K's two stiffnesses
  double rms_n = 0.0, other_rms_n = 0.0;
};

constexpr double kLineShare = 0.05;  ///< [-] width over length of a motion on one line
constexpr int kPlaneElements = 24;

/// A run whose motion lies on one line, as a run along it: displacement and force are
/// those along the line. Other runs as they are.
struct LineMotion {
  LateralRun run;
  bool on_line = false;
  double direction_rad = 0.0;  ///< of the line, from the first column's direction
};
[[nodiscard]] LineMotion along_line(const LateralRun& run);

/// @param run with across_m and across_n. @param frame of equal stiffness in both
/// directions, may be null; its deflection under the measured force is taken off.
/// @throws InputError as find_lateral_path(), and for unequal counts.
[[nodiscard]] PlaneFit fit_plane(const LateralRun& run,
                                 const FrameCompliance* frame = nullptr);

}  // namespace palpate
