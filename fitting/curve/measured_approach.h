// The part of a measurement that a response is fitted to. The part is the approach,
// with its signs as the database wants them, and what the rest of the measurement says
// about it.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "fitting/curve/fit_flag.h"
#include "fitting/curve/frame_compliance.h"
#include "formats/database/response_database.h"

namespace palpate {

/// Displacements that a fit uses [m], after the sign is turned; both ends included.
struct FitRange {
  double from_m = -std::numeric_limits<double>::infinity();
  double to_m = std::numeric_limits<double>::infinity();
};

/// Samples up to the largest displacement, in file order, compression positive.
struct Approach {
  std::vector<double> displacement_m;  ///< (n) [m] as measured, n >= kSamplesMin
  std::vector<double> force_n;         ///< (n) [N]
  /// [m] displacements before it are surely free, as somebody has stated
  double contact_from_m = -std::numeric_limits<double>::infinity();
  double noise_sd_n = 0.0;       ///< [N] standard deviation of the force's white noise
  double press_work_j = 0.0;     ///< [J] over the part that the release covers
  double release_work_j = 0.0;   ///< [J] given back; 0 without a release
  std::size_t samples = 0;       ///< of the measurement's first, up to its end
  std::size_t hold_samples = 0;  ///< held at the largest displacement, left out
  std::size_t retract_samples = 0;  ///< after it, left out
  std::size_t spikes = 0;           ///< left out
  std::size_t out_of_range = 0;     ///< outside the FitRange, left out
  double frame_deflection_m = 0.0;  ///< [m] largest that was taken off displacements
  std::vector<FitFlag> flags;
};

constexpr std::size_t kSamplesMin = 8;

/// Displacement that falls in total, and force that falls from the first samples to the
/// deepest, are turned. The approach ends where the displacement first comes within
/// 0.1 % of its travel to the largest displacement. Later samples that stay there are a
/// hold, the others a retract. Where the force falls from its peak while the machine
/// slows down to hold, the approach ends at the peak. A loop whose release gives back
/// more work than its press took (beyond 5 standard deviations of the noise's work) is
/// flagged. Single readings that stand out from all of 3 neighbours on each side by
/// more than 8 standard deviations of noise are spikes. Of 10000 samples and more,
/// means of neighbours are taken, 5000 to 10000 of them. A tool that stands still on
/// its way while the force falls is flagged.
/// @param baseline displacements that are surely before contact: its end becomes
/// contact_from_m.
/// @param frame whose deflection is taken off the displacements; may be null. Approach,
/// hold and range are separated first, by the displacements that the machine reports.
/// @throws InputError for different counts of both, a value that is not finite, no
/// travel, or an empty range. InputError too for fewer than kSamplesMin samples left or
/// beyond the baseline, and as take_off_deflection().
[[nodiscard]] Approach select_approach(const Measurement& measurement,
                                       const FitRange& range = {},
                                       const std::optional<FitRange>& baseline = {},
                                       const FrameCompliance* frame = nullptr);

/// All samples of the measurement with the signs that the approach gave it.
[[nodiscard]] Measurement turned(const Measurement& measurement,
                                 const Approach& approach);

}  // namespace palpate
