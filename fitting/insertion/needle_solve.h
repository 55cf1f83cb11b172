// The least-squares problem of a needle's passes, with events at known samples.
#pragma once

#include <vector>

#include "fitting/insertion/needle_events.h"

namespace palpate {

struct SolvedNeedle {
  NeedleSwitches switches;
  NeedleModel model;
  FittedSamples fitted;
  Eigen::VectorXd q;         ///< (parameters)
  std::vector<bool> held;    ///< (parameters) that the samples do not determine
  Eigen::VectorXd residual;  ///< (samples) [N]
  RowMajorMatrix jacobian;   ///< (samples x parameters)
  double variance = 0.0;     ///< [N^2] of the residuals
  bool converged = false;
};

/// What of a file determines its baseline.
struct BaselineSamples {
  std::size_t free = 0;  ///< before contact
  bool drift = false;    ///< whether a drift is separated from friction
};

/// (files)
[[nodiscard]] std::vector<BaselineSamples> baseline_samples(const FittedSamples& fitted,
                                                            int files,
                                                            double contact_m);

/// Samples of extractions that slide in the tissue, and of insertions in an open
/// channel: they meet friction alone.
[[nodiscard]] std::size_t friction_samples(const FittedSamples& fitted,
                                           const NeedleModel& model,
                                           const Eigen::VectorXd& q);

/// Ruptures and the end of sticking are moved to the samples that suit best.
/// @param ruptures at least one. @throws InputError as start_curve().
[[nodiscard]] SolvedNeedle solve_needle(const NeedlePath& path,
                                        const std::vector<RuptureSamples>& ruptures);

/// Of all parameters (p x p), zero for held ones; all NaN where the others cannot be
/// separated.
[[nodiscard]] Eigen::MatrixXd needle_covariance(const SolvedNeedle& solved);

}  // namespace palpate
