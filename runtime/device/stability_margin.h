// Whether a device can render a body's stiffness at a rate: the sampling bounds.
#pragma once

#include <string>

#include "formats/response/response_table.h"
#include "runtime/device/device.h"

namespace palpate {

/// The stiffest thing that a table can make the device feel. Slopes below zero need no
/// bound. A force that is held while the tool moves by dx differs from that of the
/// potential by m dx^2 / 2 of work. For m < 0 the tick takes that work. A tool that
/// such a curve lets snap through gets back what it put in, no more.
struct RenderedStiffness {
  double normal_n_per_m = 0.0;  ///< [N/m] largest slope of any curve, or of the field
  std::int64_t node = -1;       ///< where; -1 without curves
  /// [N/m] largest k_t = mu f / delta_L of the friction spring, f at the end of the
  /// curve or at the device's largest force.
  double friction_n_per_m = 0.0;
  double shaft_n_per_m = 0.0;  ///< [N/m] along a needle's shaft in its channel
  /// [N/m] k' l across the shaft, l the longest that the body has room for. 0: the
  /// database does not know l.
  double lateral_n_per_m = 0.0;
  /// [N/m] at the border of the reach, where the field falls to nothing within an
  /// element; 0: not known. Stated, not demanded.
  double border_n_per_m = 0.0;

  /// A shaft acts along the tip's curve. Friction and the sideways spring act across
  /// it. So the larger bounds the Jacobian of the force. In a channel the surface has
  /// no friction across the axis (needle_step.h): the two do not add up.
  [[nodiscard]] double largest_n_per_m() const noexcept;
};

[[nodiscard]] RenderedStiffness rendered_stiffness(const ResponseTable& stored,
                                                   double force_max_n);

/// Largest stiffness [N/m] that each bound allows; T is the time that a force is held.
/// A damped device without delay and quantisation that stays below `sampling` is
/// passive whoever holds it; above `passivity` it is only not known to be.
struct StabilityBounds {
  double passivity_n_per_m = 0.0;     ///< B / (2 T): condition (8), B > 2 T J
  double sampling_n_per_m = 0.0;      ///< 2 b / T: Colgate & Schenkel, b > K T / 2
  double delay_n_per_m = 0.0;         ///< b / (T/2 + T_delay): Diolaiti et al. 2006
  double quantisation_n_per_m = 0.0;  ///< 2 f_c / resolution: Abbott & Okamura 2005

  /// Largest stiffness that the device can render: the least of the last three. (8) is
  /// sufficient and a quarter of Colgate's bound; it is reported, not demanded.
  [[nodiscard]] double renderable_n_per_m() const noexcept;
};

/// @param hold_s [s] > 0 time between force updates. A bound without cause (no
/// quantisation) is infinite.
[[nodiscard]] StabilityBounds stability_bounds(const DeviceLimits& device,
                                               double hold_s);

/// The bounds as a table for people: what each allows, how many times the stiffness
/// that is rendered, and whether it holds. @param k_n_per_m [N/m] > 0 after any
/// scaling.
[[nodiscard]] std::string margin_table(const StabilityBounds& bounds, double k_n_per_m);

/// Why the device cannot render that stiffness; empty if it can. One line.
[[nodiscard]] std::string why_not_renderable(const RenderedStiffness& stiffness,
                                             const StabilityBounds& bounds,
                                             const DeviceLimits& device, double hold_s);

}  // namespace palpate
