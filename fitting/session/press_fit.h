// One press fitted in full: what `palpate-fit curve` says of it.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "fitting/curve/corrected_press.h"
#include "fitting/curve/family_fit.h"
#include "fitting/curve/frame_run.h"
#include "fitting/curve/time_effects.h"
#include "fitting/material/indenter.h"
#include "fitting/material/moduli.h"

namespace palpate {

struct PressFitOptions {
  FitRange range;
  Indenter indenter;
  std::optional<FrameRun> frame;          ///< the machine's
  std::optional<FitRange> baseline = {};  ///< displacements surely before contact
};

struct PressFit {
  std::size_t samples = 0;        ///< of the press
  std::optional<FrameRun> frame;  ///< as given
  PressCorrections corrections;   ///< what the machine added, taken off
  Approach approach;
  ContactFit contact;   ///< the power law's
  FamilyChoice choice;  ///< of all families, by AICc; none of an empty run
  Modulus modulus;
  std::vector<FitFlag> flags;  ///< the fit's, then the modulus' own
  /// find_stepwise_relaxation(), where the caller has sought it: of the press as read,
  /// whose times the fit may do without.
  std::optional<Relaxation> relaxation = {};
};

/// @param press a single one. @throws InputError as correct_press().
[[nodiscard]] PressFit fit_press(const Measurement& press,
                                 const PressFitOptions& options);

/// The family that a database gets. @throws NumericalError of an empty run.
[[nodiscard]] const FamilyFit& best_of(const PressFit& fit);

/// For programs: numbers that are not known as null. `relaxation` only of several
/// holds.
[[nodiscard]] nlohmann::ordered_json to_json(const PressFit& fit,
                                             const Indenter& indenter);

}  // namespace palpate
