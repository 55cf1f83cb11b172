// From estimates of error to errors that hold, measured at places that were solved
// again, better. Split conformal prediction (Lei, G'Sell, Rinaldo, Tibshirani and
// Wasserman, J. Am. Stat. Assoc. 113, 2018, section 5.2).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace palpate {

/// The share of places whose error is to be within what is stated.
inline constexpr double kErrorCoverage = 0.95;

/// Fewer checks cannot tell the 95 % quantile: the largest of n ratios covers
/// n / (n + 1).
inline constexpr std::size_t kChecksToCalibrate = 19;

/// Times an estimate where nothing was measured, and at least elsewhere: a few dozen
/// checks may all miss what is rare on a body. An organ's 24 ask for 1.1, which covers
/// 20 of 24 other nodes solved on meshes four times as fine; 1.5 covers 23. A liver's
/// ask for 2.8 (HISTORY.md): an error that was not checked is no promise.
inline constexpr double kLeastErrorFactor = 1.5;

/// What covers 95 % of new values like these: the ceil(0.95 (n + 1))-th smallest, the
/// largest of fewer than 19, which is no guarantee. @param values (n >= 1).
[[nodiscard]] double covering(std::vector<double> values);

/// The share of new values that covering() of n values, of which `known` are known, is
/// stated to cover. The share is n / (n + 1) of few values, less where what is known
/// does not reach that far.
[[nodiscard]] double covered_share(std::size_t known, std::size_t n);

/// [-] The factor on estimates that covers 95 % of new places, whatever the
/// distribution of errors, if checked places were chosen at random. The factor is
/// covering() of the ratios of error and estimate, and at least kLeastErrorFactor.
/// @param estimate (n) [-] positive. @param error (n) [-] found at the same places;
/// infinite where the check itself failed, so that nobody knows the error. Where
/// infinite errors reach into what is to be covered, the largest known one is taken
/// (covered_share()).
[[nodiscard]] double calibrate_errors(std::span<const double> estimate,
                                      std::span<const double> error);

/// What estimates are expected to be multiplied by while a build runs, which knows no
/// checks yet.
inline constexpr double kExpectedErrorFactor = kLeastErrorFactor;

/// The error of a solution at a vertex over its difference to a check. Ratios are
/// medians of presses beside much finer ones. The ratio was 1.4 of a linear organ, 0.9
/// of a linear liver and 1.0 of a neo-Hookean gel (press_error_study, MEASURED.md).
inline constexpr double kErrorPerCheck = 1.6;

}  // namespace palpate
