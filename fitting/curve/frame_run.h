// The compliance of a machine's frame from a run on a rigid plate.
#pragma once

#include <cstddef>

#include "fitting/curve/frame_compliance.h"

namespace palpate {

struct FrameRun {
  FrameCompliance frame;
  double force_max_n = 0.0;     ///< [N] above the force before contact
  double rms_n = 0.0;           ///< [N] of the residuals of the chosen curve
  double straight_rms_n = 0.0;  ///< [N] of those of a constant stiffness
  std::size_t samples = 0;      ///< in contact
};

constexpr int kFramePieces = 6;
constexpr std::size_t kFrameSamplesMin = 20;

/// The approach's force over displacement. The curve begins at the last sample that is
/// within three standard deviations of noise, or 0.5 % of the largest force, of the
/// baseline. The fit is a straight line, F = a + k x, or kFramePieces straight pieces,
/// none falling. Pieces are taken where they fit better and leave the line by more than
/// 2 % of the largest force. Deviance (misfit.h) and chi squared at 0.1 % decide what
/// fits better. The first piece then states where the plate was met. Standard
/// deviations are under the noise of the residuals (covariance_under_noise), with that
/// of the baseline's slope.
/// @throws InputError for an empty run, fewer than kFrameSamplesMin samples in contact,
/// and a force that does not rise with the displacement. InputError too for a run that
/// begins in contact where the stiffness is not constant.
[[nodiscard]] FrameRun frame_of_run(const Measurement& measurement);

}  // namespace palpate
