// How a dent that nobody touches goes back.
//
// The relaxed forces q_k of a place carry s = sum g_k q_k between them. Left alone the
// surface is without force, p = s, and they follow
//
//   q_k' = (s - q_k) / tau_k,
//
// linear, without the response's curve. lambda_r are the roots of
// 1 = sum g_k / (1 + lambda tau_k), one in each interval (-1/tau_r, -1/tau_{r+1}) and
// the last in (-1/tau_K, 0]. With zeta_rk = 1 + lambda_r tau_k,
//
//   q_k(t) = q_k(0) e^(-t/tau_k) + sum_r c_r (e^(lambda_r t) - e^(-t/tau_k)) / zeta_rk,
//   c_r = sum_k g_k tau_k q_k(0) / zeta_rk / sum_k g_k tau_k / zeta_rk^2
//
// (a diagonal and a product of two vectors: eigenvectors 1 / zeta_rk to the right,
// g_k tau_k / zeta_rk to the left).
#pragma once

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/element/element.h"

namespace palpate {

/// A value per term; those beyond a tool's terms are zero.
using TermValues = Eigen::Array<Real, kMemoryTerms, 1>;

/// Terms of a relaxation: K of them, in the order of their times.
struct RelaxationTimes {
  Eigen::Index terms = 0;                   ///< K
  TermValues tau_s = TermValues::Zero();    ///< [s] tau_k > 0, increasing
  TermValues rate_hz = TermValues::Zero();  ///< [1/s] 1 / tau_k
};

/// The relaxed forces after a time without contact; to rounding for any time.
/// @param relaxed_n [N] q_k >= 0.
/// @param relaxing  [-] g_k >= 0, sum at most 1.
/// @param time_s    [s] >= 0.
[[nodiscard]] TermValues recovered_freely(const RelaxationTimes& times,
                                          const TermValues& relaxed_n,
                                          const TermValues& relaxing,
                                          Real time_s) noexcept;

}  // namespace palpate
