// What a tool's motion under a force that is known says of it.
#pragma once

#include <vector>

namespace palpate {

struct ProbeSample {
  double time_s = 0.0;  ///< [s] since the force was first asked for
  double way_m = 0.0;   ///< [m] along it, from where that was
};

/// A tool that a force F pushes from rest, over dry friction f and viscous damping b:
///
///   x = x0 + a (B s - 1 + e^(-B s)) / B^2,   s = t - delay > 0,   a = (F - f) / m,   B
///   = b / m
///
/// With the standard deviations of their estimates: of least squares or of the pushes
/// among one another, whichever is more.
struct PushFit {
  double acceleration_m_per_s2 = 0.0;  ///< a
  double acceleration_sd = 0.0;
  double decay_per_s = 0.0;  ///< B
  double decay_sd = 0.0;
  double delay_s = 0.0;
  double delay_sd = 0.0;
  double rms_m = 0.0;  ///< [m] of what the fit leaves
};

/// One a, B and delay for all pushes, each with an x0 of its own: where in a step of
/// the measured positions it began. @param pushes with 10 samples or more in all, as
/// long as push_s at most.
[[nodiscard]] PushFit fit_pushes(const std::vector<std::vector<ProbeSample>>& pushes,
                                 double push_s);

/// [s] when a tool began to move under a force that rises steadily. From then on
/// m x'' = r (t - t_f), so the cube root of its way is linear in time. The time is
/// where that line is zero.
/// @param least_m samples on a shorter way say nothing. The last sample's time where no
/// line can be drawn.
[[nodiscard]] double begin_of_motion_s(const std::vector<ProbeSample>& samples,
                                       double least_m);

}  // namespace palpate
