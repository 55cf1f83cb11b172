// What a fit found wrong or had to change in a measurement, by name.
#pragma once

#include <string_view>

namespace palpate {

enum class FitFlag {
  kDepthSignTurned,
  kForceSignTurned,
  kHoldCutOff,
  kForceRisesInHold,
  kRetractCutOff,
  kNonMonotoneDepth,
  kNonPassiveLoop,
  kSpikes,
  kEmptyRun,
  kAlreadyInContact,
  kContactPointNotIdentified,
  kParameterAtBound,
  kCovarianceNotAvailable,
  kMisfit,
  kHertzDepthExceeded,
  kHertzExponentRefuted,
  kModulusLawMisfit,
  kFrameTakesMost,
  kTimeDriftRemoved,
  kAdhesion,
  kNotConverged,
  kSeveralHolds,
};

/// As reports name it: "already_in_contact".
[[nodiscard]] std::string_view flag_name(FitFlag flag) noexcept;

/// One line for people: what was found and what follows from it.
[[nodiscard]] std::string_view flag_meaning(FitFlag flag) noexcept;

}  // namespace palpate
