#include "fitting/curve/fit_flag.h"

namespace palpate {
namespace {

struct Text {
  std::string_view name, meaning;
};

Text text(FitFlag flag) noexcept {
  switch (flag) {
    case FitFlag::kDepthSignTurned:
      return {"depth_sign_turned", "displacement falls under compression; turned"};
    case FitFlag::kForceSignTurned:
      return {"force_sign_turned", "force falls under compression; turned"};
    case FitFlag::kHoldCutOff:
      return {"hold_cut_off", "samples held at the largest displacement are left out"};
    case FitFlag::kForceRisesInHold:
      return {
          "force_rises_in_hold",
          "the force rises while the displacement stands: it is clipped, or another "
          "column is the depth"};
    case FitFlag::kRetractCutOff:
      return {"retract_cut_off", "samples after the largest displacement are left out"};
    case FitFlag::kNonMonotoneDepth:
      return {"non_monotone_depth", "displacement goes back during the approach"};
    case FitFlag::kNonPassiveLoop:
      return {"non_passive_loop",
              "release gives more work than the press took; no damping can do that"};
    case FitFlag::kSpikes:
      return {"spikes", "single readings far off their neighbours are left out"};
    case FitFlag::kEmptyRun:
      return {"empty_run", "force rises by less than 5 standard deviations of noise"};
    case FitFlag::kAlreadyInContact:
      return {"already_in_contact",
              "no free travel: depth is counted from the first sample"};
    case FitFlag::kContactPointNotIdentified:
      return {"contact_point_not_identified",
              "contact point assumed, or uncertain by more than 10 % of the depth"};
    case FitFlag::kParameterAtBound:
      return {"parameter_at_bound", "a parameter stopped at its bound and was held"};
    case FitFlag::kCovarianceNotAvailable:
      return {"covariance_not_available", "the parameters cannot be told apart"};
    case FitFlag::kMisfit:
      return {"misfit",
              "the law misses the data by more than their noise: it is not the law"};
    case FitFlag::kHertzDepthExceeded:
      return {
          "hertz_depth_exceeded",
          "deeper than a quarter of the radius: Hertz's parabola is not the sphere"};
    case FitFlag::kModulusLawMisfit:
      return {"modulus_law_misfit",
              "the modulus' law misses the data by more than their noise"};
    case FitFlag::kHertzExponentRefuted:
      return {"hertz_exponent_refuted",
              "the free exponent is not 1.5: the modulus depends on depth"};
    case FitFlag::kFrameTakesMost:
      return {"frame_takes_most",
              "the machine's frame takes more than half of the travel in contact"};
    case FitFlag::kTimeDriftRemoved:
      return {
          "time_drift_removed",
          "the force drifts with time, as free samples show; the drift is taken off"};
    case FitFlag::kAdhesion:
      return {
          "adhesion",
          "the force falls clearly below the baseline: the specimen sticks, contact "
          "point and laws that only push are off"};
  }
  return {};
}

}  // namespace

std::string_view flag_name(FitFlag flag) noexcept {
  return text(flag).name;
}

std::string_view flag_meaning(FitFlag flag) noexcept {
  return text(flag).meaning;
}

}  // namespace palpate
