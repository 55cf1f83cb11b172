// One fit of the power law to one approach, whether or not the law follows it:
// fit_contact() judges that.
#pragma once

#include <optional>

#include "fitting/curve/power_law_fit.h"

namespace palpate {

/// Parameters, deviations and flags as ContactFit says; neither `beginning` nor
/// `free_to_m`.
/// @param drift_max_n_per_m > 0 the steepest drift, however uncertain it is; without,
/// one is given up only where it is surely too steep (power_law_search.h)
[[nodiscard]] ContactFit fit_once(const Approach& approach,
                                  const ContactFitOptions& options,
                                  std::optional<double> drift_max_n_per_m = {});

/// Whether the contact point's deviation is within kContactSdShareMax of the depth.
[[nodiscard]] bool is_known(const ContactFit& fit);

}  // namespace palpate
