// Mean of measurements of several specimens, with what scatters at a point, between
// points and between specimens.
//
//   y_ijk = m + s_i + p_ij + e_ijk
//
// Symbols: y_ijk repeat k at point j of specimen i, m mean, s, p, e independent and
// normal with mean 0. Variances are by the method of moments on unweighted means. For a
// balanced design that method is the analysis of variance of the textbooks. The mean is
// that of the specimens' means. The mean's interval is Student's t with one degree of
// freedom less than specimens: exact for a balanced design. (Searle, Casella and
// McCulloch 1992, chapter 3.)
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace palpate {

struct RandomEffects {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  double mean = 0.0;
  double mean_sd = kUnknown;                  ///< standard error; NaN for one specimen
  double lower = kUnknown, upper = kUnknown;  ///< 95 % interval of the mean
  double repeat_sd = kUnknown;                ///< within points; NaN without repeats
  double point_sd = kUnknown;                 ///< between points of one specimen
  double specimen_sd = kUnknown;    ///< between specimens, with what points and repeats
                                    ///< add where those are not known
  double degrees_of_freedom = 0.0;  ///< of the interval
  std::size_t specimens = 0, points = 0, values = 0;
};

/// @param y values of the repeats, by specimen and point; none of the lists is empty. A
/// variance whose estimate is negative is 0.
[[nodiscard]] RandomEffects random_effects(
    const std::vector<std::vector<std::vector<double>>>& y);

}  // namespace palpate
