// One press, fitted after what belongs to the machine is taken off: the frame's
// deflection and a drift of the force with time.
#pragma once

#include <optional>

#include "fitting/curve/frame_compliance.h"
#include "fitting/curve/jkr_fit.h"
#include "fitting/curve/time_drift.h"

namespace palpate {

struct PressCorrections {
  FrameEffect frame;
  TimeDrift drift;
  Adhesion adhesion;
  std::optional<JkrFit> jkr = {};  ///< where a sphere pressed and adhesion is seen
};

struct CorrectedPress {
  Measurement samples;  ///< drift taken off; displacements that the machine reports
  Measurement moved;    ///< the same, displacements of the tip
  Approach approach;    ///< of the tip
  ContactFit contact;   ///< its flags with those of the corrections
  PressCorrections corrections;
  /// With the frame softer by one standard deviation, where that is known.
  struct Softer {
    Approach approach;
    ContactFit contact;
  };
  std::optional<Softer> softer;
};

/// Frame, then drift, then both again on what is left, then adhesion. Flags
/// kFrameTakesMost, kTimeDriftRemoved and kAdhesion go to `contact`.
/// @param noise_relative as ContactFitOptions'. @param frame may be null. @throws
/// InputError as select_approach().
[[nodiscard]] CorrectedPress correct_press(const Measurement& press,
                                           const FrameCompliance* frame,
                                           const FitRange& range = {},
                                           const std::optional<FitRange>& baseline = {},
                                           double noise_relative = 0.0);

}  // namespace palpate
