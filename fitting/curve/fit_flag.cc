#include "fitting/curve/fit_flag.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace palpate {
namespace {

struct Text {
  FitFlag flag;
  std::string_view name, meaning;
};

constexpr Text kText[] = {
    {FitFlag::kDepthSignTurned, "depth_sign_turned",
     "displacement falls under compression; turned"},
    {FitFlag::kForceSignTurned, "force_sign_turned",
     "force falls under compression; turned"},
    {FitFlag::kHoldCutOff, "hold_cut_off",
     "samples held at the largest displacement are left out"},
    {FitFlag::kForceRisesInHold, "force_rises_in_hold",
     "the force rises while the displacement stands: it is clipped, or another "
     "column is the depth"},
    {FitFlag::kRetractCutOff, "retract_cut_off",
     "samples after the largest displacement are left out"},
    {FitFlag::kNonMonotoneDepth, "non_monotone_depth",
     "displacement goes back during the approach"},
    {FitFlag::kNonPassiveLoop, "non_passive_loop",
     "release gives more work than the press took; no damping can do that"},
    {FitFlag::kSpikes, "spikes",
     "single readings far off their neighbours are left out"},
    {FitFlag::kEmptyRun, "empty_run",
     "force rises by less than 5 standard deviations of noise"},
    {FitFlag::kAlreadyInContact, "already_in_contact",
     "no free travel: depth is counted from the first sample"},
    {FitFlag::kContactPointNotIdentified, "contact_point_not_identified",
     "contact point assumed, uncertain by more than 10 % of the depth, or of a law "
     "that follows no beginning of the curve: baseline_m tells what is surely free"},
    {FitFlag::kParameterAtBound, "parameter_at_bound",
     "a parameter stopped at its bound and was held"},
    {FitFlag::kCovarianceNotAvailable, "covariance_not_available",
     "the parameters cannot be separated"},
    {FitFlag::kMisfit, "misfit",
     "the law misses the data by more than their noise: it is not the law"},
    {FitFlag::kHertzDepthExceeded, "hertz_depth_exceeded",
     "deeper than a quarter of the radius: Hertz's parabola is not the sphere"},
    {FitFlag::kModulusLawMisfit, "modulus_law_misfit",
     "the modulus' law misses the data by more than their noise: fit the part where it "
     "holds (from_m, to_m)"},
    {FitFlag::kHertzExponentRefuted, "hertz_exponent_refuted",
     "the free exponent is not 1.5: the modulus depends on depth"},
    {FitFlag::kFrameTakesMost, "frame_takes_most",
     "the machine's frame takes more than half of the travel in contact"},
    {FitFlag::kTimeDriftRemoved, "time_drift_removed",
     "the force drifts with time, as free samples show; the drift is taken off"},
    {FitFlag::kAdhesion, "adhesion",
     "the force falls clearly below the baseline: the specimen sticks, contact "
     "point and laws that only push are off"},
    {FitFlag::kNotConverged, "not_converged",
     "the power law's fit did not converge; the families' own are judged alone"},
    {FitFlag::kSeveralHolds, "several_holds",
     "the tool stands still on its way and goes on: what relaxes there is in the fit; "
     "end it before the first hold (to_m)"},
};
static_assert(std::size(kText) == static_cast<std::size_t>(FitFlag::kSeveralHolds) + 1);

Text text(FitFlag flag) noexcept {
  const auto* const found =
      std::find_if(std::begin(kText), std::end(kText), [flag](const Text& t) {
        return t.flag == flag;
      });
  return found == std::end(kText) ? Text{} : *found;
}

}  // namespace

std::string_view flag_name(FitFlag flag) noexcept {
  return text(flag).name;
}

std::string_view flag_meaning(FitFlag flag) noexcept {
  return text(flag).meaning;
}

}  // namespace palpate
