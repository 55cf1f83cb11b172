// Joint fit of the runs of a lateral test: tangential stiffness, friction coefficient,
// presliding length and loss of energy, under both laws of contact (contact_law.h).
//
// Each run is fitted by least squares (loop_solve.h), its intervals under the noise of
// its own residuals. The coefficient mu = S / N is one of all runs: the weighted mean
// of their logarithms. Where mu and k of a run correlate, k follows the common mu. Runs
// whose coefficients differ beyond noise keep their own, and the mean has the spread.
#pragma once

#include <string>
#include <vector>

#include "fitting/curve/frame_compliance.h"
#include "fitting/lateral/loop_loss.h"
#include "fitting/numerics/interval_estimate.h"

namespace palpate {

/// One run under one law.
struct RunFit {
  std::string name;
  double depth_m = 0.0, normal_n = 0.0;  ///< NaN: not known
  IntervalEstimate stiffness_n_per_m;    ///< k of the contact, at the mean normal force
  IntervalEstimate slip_force_n;         ///< S at the mean normal force
  IntervalEstimate friction;             ///< [-] mu of this run alone
  IntervalEstimate presliding_m;         ///< S / k
  IntervalEstimate loss_j;               ///< measured, mean of the closed loops
  IntervalEstimate modelled_loss_j;
  IntervalEstimate drift_n;  ///< over the run
  double offset_n = 0.0;     ///< of the force
  double zero_m = 0.0;       ///< displacement without tangential force
  double rms_n = 0.0;        ///< of the residuals
  std::vector<LoopCycle> cycle;
  LoopSamples samples;
  std::vector<std::string> notes;  ///< a sentence each
};

struct LawFit {
  ContactLaw law = ContactLaw::kSharpSlip;
  std::vector<RunFit> runs;       ///< one of each run
  IntervalEstimate friction;      ///< mu of all runs
  IntervalEstimate presliding_m;  ///< mean over the runs
  double rms_n = 0.0;
  bool frictions_differ = false;
};

struct LateralFit {
  LawFit better, other;
  double deviance = 0.0;  ///< [-] -2 log of how much less likely the other law is
  [[nodiscard]] bool laws_differ() const { return deviance > kLawDeviance; }
  static constexpr double kLawDeviance = 6.0;  ///< odds of 20
};

/// @param frame of the instrument, in series with the contact; may be null.
/// @throws InputError for no run, a frame whose stiffness is not constant, and as
/// find_lateral_path(), naming the run.
[[nodiscard]] LateralFit fit_lateral(const std::vector<LateralRun>& runs,
                                     const FrameCompliance* frame = nullptr);

}  // namespace palpate
