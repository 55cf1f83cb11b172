// A specimen pressed again and again: which press counts, and how the presses settle.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "fitting/curve/measured_approach.h"

namespace palpate {

/// Which presses of a file are fitted.
struct CycleChoice {
  enum class Kind { kFirst, kLast, kAll, kNumber };
  Kind kind = Kind::kAll;
  std::size_t number = 1;  ///< of kNumber, counted from 1
};

/// "first", "last", "all", or a number from 1. @throws InputError otherwise.
[[nodiscard]] CycleChoice parse_cycle(std::string_view text);

/// The other way round.
[[nodiscard]] std::string cycle_text(const CycleChoice& choice);

/// Numbers of the presses chosen, from 1. @throws InputError where there are fewer
/// presses than the number.
[[nodiscard]] std::vector<std::size_t> chosen_cycles(const CycleChoice& choice,
                                                     std::size_t presses);

/// What one press of several did.
struct CycleSummary {
  std::string bad;            ///< why nothing more is known; empty where it is
  double peak_force_n = 0.0;  ///< [N] above the baseline
  double press_work_j = 0.0;  ///< [J] of the approach
  double loss_j = std::numeric_limits<double>::quiet_NaN();
  ///< [J] press less release; NaN without a release
  double loss_factor = std::numeric_limits<double>::quiet_NaN();
  ///< [-] loss over pi times the sum of press and release work
  double contact_point_m = std::numeric_limits<double>::quiet_NaN();
  double contact_point_sd_m = std::numeric_limits<double>::quiet_NaN();
  double contact_shift_m = std::numeric_limits<double>::quiet_NaN();
  ///< [m] contact point less that of the last press: negative where the specimen has
  ///< sunk since
  double contact_shift_sd_m = std::numeric_limits<double>::quiet_NaN();
};

/// One of each press, none for a single one. Works are over the travel that approach
/// and release both cover, of the approach alone without a release. Forces are counted
/// from the baseline of the press' own fit.
/// @param presses of split_presses(). @param frame may be null.
[[nodiscard]] std::vector<CycleSummary> summarise_cycles(
    const std::vector<Measurement>& presses, const FrameCompliance* frame);

}  // namespace palpate
