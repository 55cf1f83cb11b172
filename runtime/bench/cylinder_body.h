// The paper's virtual body: a deformable cylinder with the normal responses (31).
#pragma once

#include "formats/database/response_database.h"

namespace palpate {

struct CylinderBodyOptions {
  double stiffness_n_per_m = 170.0;  ///< [N/m] k > 0; the paper's largest stable one
  double radius_m = 0.03;            ///< [m] > 0 about the x axis
  double length_m = 0.14;            ///< [m] > 0
  double tool_radius_m = 0.006;      ///< [m] > 0 of the ball
  double friction = 0.3;             ///< [-] [0, 10]
  double presliding_m = 5e-4;        ///< [m] > 0
  int around = 56;                   ///< [-] >= 3 nodes on a ring
  int along = 40;                    ///< [-] >= 2 rings less one
};

/// f(d) = 100 k d^2 for d <= 5 mm, then k (d - 2.5 mm): value and slope are continuous.
/// The paper prints 0.000025 where 0.0025 m must stand, else f would jump at 5 mm. The
/// paper prints "0 <= delta" for free space where "delta <= 0" is meant.
[[nodiscard]] double cylinder_force_n(double stiffness_n_per_m, double depth_m);

/// The same curve at every node of the side, along its normal, to 10 mm. The ends and
/// the rings at them have no response.
[[nodiscard]] ResponseDatabase cylinder_body(const CylinderBodyOptions& options);

}  // namespace palpate
