// From the curve of a press at some speed to the instantaneous response behind it.
//
// A press with speed v through depths d = v t shows
//
//   f = p - sum g_k q_k,   q_k' = (p - q_k) / tau_k,   p the instantaneous force.
//
// With p linear in time over a step h and x = h / tau_k, e = exp(-x), m = (1 - e) / x,
//
//   q_k <- e q_k + (m - e) p_before + (1 - m) p,
//   p = (f + sum g_k (e q_k + (m - e) p_before)) / (1 - sum g_k (1 - m)).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "formats/response/curve_view.h"
#include "formats/response/response_table.h"
#include "formats/response/viscoelasticity.h"

namespace palpate {

/// A curve of its own.
struct OwnedCurve {
  std::vector<double> depth_m;
  std::vector<double> force_n;
  std::vector<double> stiffness_n_per_m;
  std::vector<double> energy_j;

  [[nodiscard]] CurveView view() const noexcept {
    return {depth_m, force_n, stiffness_n_per_m, energy_j};
  }
};

/// The instantaneous response at the depths of a press's curve. Forces follow by the
/// recursion above in steps between the samples. Slopes are f' + sum g_k (p - q_k) /
/// (tau_k v), limited so that the cubics do not overshoot.
/// @param g     (K) [-] >= 0, sum at most 1.
/// @param tau_s (K) [s] > 0.
/// @param speed_m_per_s [m/s] > 0.
[[nodiscard]] OwnedCurve instantaneous_curve(const CurveView& press,
                                             const Eigen::RowVectorXd& g,
                                             const std::vector<double>& tau_s,
                                             double speed_m_per_s);

/// The curve of a node as it is rendered: its own where that is instantaneous or
/// static.
[[nodiscard]] OwnedCurve instantaneous_curve(const CurveView& curve,
                                             const Viscoelasticity& relaxation,
                                             std::int64_t node);

/// All curves of a table as they are rendered, and their largest slopes. Nothing
/// changes where they are instantaneous or static.
void make_instantaneous(ResponseTable& table);

/// Upper bound of the largest slope of the instantaneous curve, over that of the
/// press's. The bound is 1 / (1 - sum g), infinite where all of the force relaxes.
[[nodiscard]] double stiffness_factor(const Viscoelasticity& relaxation);

}  // namespace palpate
