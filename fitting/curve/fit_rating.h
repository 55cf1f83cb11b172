// How far a fit may be trusted: features, gates and a score.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "fitting/curve/family_fit.h"
#include "fitting/curve/measured_approach.h"
#include "fitting/curve/power_law_fit.h"

namespace palpate {

/// What the gates and the score are made of.
struct RatingFeatures {
  double rms_over_noise = std::numeric_limits<double>::quiet_NaN();  ///< [-]
  double runs_z = std::numeric_limits<double>::quiet_NaN();
  ///< [-] too few changes of the residuals' sign, in standard deviations (negative)
  double near_contact_over_noise = std::numeric_limits<double>::quiet_NaN();
  ///< [-] rms in the first tenth of the depth, over the noise
  double repeat_scatter = std::numeric_limits<double>::quiet_NaN();
  ///< [-] standard deviation over mean of the force, among the repeats at one point
  double correlation_max = std::numeric_limits<double>::quiet_NaN();
  ///< [-] [0, 1] largest between two free parameters
  std::size_t samples_in_contact = 0;
};

/// Whether the chosen family misses is what matters, not whether the power law does.
void take_misfit(const FamilyChoice& choice, std::vector<FitFlag>& flags);

enum class Verdict { kUse, kCheck, kSkip };
[[nodiscard]] std::string_view verdict_name(Verdict verdict) noexcept;

struct Rating {
  RatingFeatures features;
  std::vector<std::string> gates;  ///< names of those that the run did not pass
  double score = 0.0;              ///< [-] [0, 1]; 0 for a run to skip
  Verdict verdict = Verdict::kSkip;
};

/// Gates to skip: empty_run, too_few_samples (8 in contact), implausible_units (depth
/// outside [1 nm, 0.5 m], force outside [1 pN, 100 kN]), not_converged. Gates to check:
/// the flags already_in_contact, contact_point_not_identified, non_monotone_depth,
/// non_passive_loop, misfit of the chosen family, force_falls, and parameter_at_bound
/// of an exponent or contact point. Score: a product. Rms and near-contact rms have the
/// factor 1 / (1 + max(0, ratio - 1) / 5) each. Runs have the factor 1 / (1 + max(0,
/// -runs_z) / 20). Every gate to check has the factor 1 / 2.
[[nodiscard]] Rating rate(const ContactFit& fit, const FamilyChoice& choice);

}  // namespace palpate
