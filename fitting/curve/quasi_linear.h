// Fung's quasi-linear viscoelastic force of a curve, while contact is kept:
//
//   f(t) = e(t) - sum_k g_k q_k(t),  tau_k q_k'(t) = e(t) - q_k(t),
//
// e(t) = f_e(d(t)) [N] is what the instantaneous curve f_e gives at once. q_k [N] is
// the force that has relaxed into term k, g_k >= 0, sum g_k <= 1. f is the convolution
// f = int G(t - s) de(s), G(t) = 1 - sum_k g_k (1 - exp(-t / tau_k)) (Fung 1981, 7.6).
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace palpate {

struct RelaxationTerm {
  double g = 0.0;  ///< [-] of the instantaneous force
  double g_sd = 0.0;
  double tau_s = 0.0;     ///< [s]
  double tau_sd_s = 0.0;  ///< tau exp(+-2 tau_sd / tau) is the 95 % interval
  /// Why the measurement says nothing of it: longer than the hold, shorter than the
  /// samples' interval; empty where it does.
  std::string not_claimed;
};

/// q (n x c) of one term for c signals e (n x c) at times t (n) that do not fall. Exact
/// for signals that are linear between the times. q = e at the first.
[[nodiscard]] Eigen::MatrixXd relaxed_force(const Eigen::VectorXd& time_s,
                                            const Eigen::MatrixXd& elastic,
                                            double tau_s);

/// What a hold shows of terms after a press at constant speed. The terms' times go with
///   g'_k = g_k (e - q_k) / f
/// at the end of the press. So the held force is
///   f (1 - sum_k g'_k (1 - exp(-t / tau_k))).
/// @param displacement_m, force_n (m >= 2) of the instantaneous curve, rising from its
/// first depth without force; linear between them. @param speed_m_per_s > 0
[[nodiscard]] std::vector<RelaxationTerm> shown_by_press(
    std::span<const RelaxationTerm> terms, std::span<const double> displacement_m,
    std::span<const double> force_n, double speed_m_per_s);

}  // namespace palpate
