// The power law that fits an approach best, in units of the approach's own ranges. The
// search finds from which start, on which samples, with or without a drift, from where
// in contact.
#pragma once

#include <cstddef>
#include <optional>

#include "fitting/curve/measured_approach.h"
#include "fitting/curve/power_law_solve.h"
#include "fitting/curve/power_law_start.h"

namespace palpate {

/// The approach over its travel and the range of its force, and how to get back.
struct ScaledApproach {
  ScaledCurve curve;
  double x_min_m = 0.0, length_m = 1.0, force_n = 1.0;
  double noise = 0.0;  ///< [-] white
};

struct PowerLawSolution {
  ContactModel model;
  HeldParameters held{};           ///< given, assumed, or at a bound
  ScaledCurve used;                ///< without the outliers
  bool from_first_sample = false;  ///< contact is assumed there, without drift
  std::size_t outliers = 0;
  int iterations = 0;  ///< of all starts
  bool converged = false;
};

constexpr double kDriftShareMax = 0.1;  ///< [-] of the force range, over the travel
constexpr std::size_t kFreeSamplesMin = 3;

/// @param noise_relative as ContactFitOptions'
[[nodiscard]] ScaledApproach scale_approach(const Approach& approach,
                                            double noise_relative);

/// Whether the force never leaves the noise of the baseline. That noise is the first
/// fifth's about its mean slope, or the white noise if that is larger.
[[nodiscard]] bool is_empty(const Approach& approach);

/// As fit_contact() says. @param exponent held; free without.
/// @param drift_max steepest baseline [-] that is a drift and not the body, whatever
/// its standard deviation; without, kDriftShareMax, where it is surely steeper.
[[nodiscard]] PowerLawSolution search_power_law(const ScaledApproach& approach,
                                                std::optional<double> exponent,
                                                std::optional<double> drift_max);

}  // namespace palpate
