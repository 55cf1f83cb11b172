// Relaxation as shares of the force that are gone at a few times. Presses with holds
// determine these shares well, while the terms of one press trade against each other.
//
//   y_m = sum_k g_k (1 - exp(-t_m / tau_k)),   m, k = 1 .. K
//
// with tau common to a body: y and g tell the same.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "fitting/surface/gaussian_field.h"
#include "fitting/surface/probe.h"

namespace palpate {

/// K times [s], rising: between the two tau (their geometric mean, at most half of the
/// holds), and the end of the holds. Of one tau the end alone.
/// @param tau_s 1 or 2, rising. @param seconds > 0, of the holds.
[[nodiscard]] std::vector<double> share_times_s(std::span<const double> tau_s,
                                                double seconds);

/// (K x K) 1 - exp(-t_m / tau_k).
[[nodiscard]] Eigen::MatrixXd shares_of_terms(std::span<const double> time_s,
                                              std::span<const double> tau_s);

/// The g (K) with g >= 0 and sum g <= 1 whose shares are nearest to those given. The
/// true shares are of such g, so they are never farther from these than from `shares`.
/// @param of_terms shares_of_terms(). @param shares (K) any.
[[nodiscard]] Eigen::VectorXd nearest_terms(const Eigen::MatrixXd& of_terms,
                                            const Eigen::VectorXd& shares);

/// What each probe says of the share at each time, a set a time, with its own standard
/// deviation. The deviation is at least 0.001, which stands also where the deviation is
/// not known: then the nugget has it. Not used where it is 0.5 or more.
/// @param held probes whose press and hold were fitted together.
[[nodiscard]] std::vector<FieldData> held_shares(
    const std::vector<const SurfaceProbe*>& held, std::span<const double> time_s);

/// Root mean square over probes and times up to the holds' end, evenly in their
/// logarithm. Squared is each probe's shares less the shares of the common tau that
/// agree with the probe at the times of share_times_s(). The root is what tau common to
/// a body miss.
[[nodiscard]] double common_times_error(const std::vector<const SurfaceProbe*>& held,
                                        std::span<const double> tau_s, double seconds);

/// The tau that miss least of the median probe (as above), rising, each within a factor
/// of 3 of those given.
[[nodiscard]] std::vector<double> times_that_miss_least_s(
    const std::vector<const SurfaceProbe*>& held, std::span<const double> tau_s,
    double seconds);

}  // namespace palpate
