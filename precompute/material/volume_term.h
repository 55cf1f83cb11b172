// Measures of volume change theta(F), the arguments of a law's volume term.
#pragma once

#include "precompute/material/law_response.h"

namespace palpate {

/// theta [-]; 0 for VolumeMeasure::kNone. Formulas: law_response.h.
[[nodiscard]] double volume_theta(VolumeMeasure measure, const Eigen::Matrix3d& F);

/// theta, d theta/dF, d2 theta/dF2 [-].
[[nodiscard]] VolumeResponse volume_response(VolumeMeasure measure,
                                             const Eigen::Matrix3d& F);

}  // namespace palpate
