// The force of a contact against its lateral displacement, from rest to sliding.
//
//   sharp slip     g = u_c / x_p                          slides from u_c = x_p on
//   partial slip   g = 1 - (1 - u_c / x_s)^(3/2)          slides from u_c = x_s on
//
// Symbols: q = S g tangential force [N], S force while the contact slides [N], k
// tangential stiffness at rest [N/m]. u_c is the displacement of the contact [m], x_p =
// S / k the presliding length [m], x_s = 3/2 x_p. Both laws begin with the stiffness k.
// Sharp slip is what the runtime renders (FrictionSpring). Partial slip is of Cattaneo
// (1938) and Mindlin (1949): a ring of the contact slips, and grows inwards.
//
// An instrument of stiffness k_i in series moves u = u_c + q / k_i.
//
// After a reversal the force follows the same curve at twice its scale (Masing 1926),
// friction_history.h. The loss in a loop of amplitude X is then 8 int_0^X q du - 4 X
// q(X), a spring in series loses nothing.
#pragma once

#include <limits>
#include <string_view>

namespace palpate {

enum class ContactLaw { kSharpSlip, kPartialSlip };

/// "sharp slip", "partial slip"
[[nodiscard]] std::string_view law_name(ContactLaw law) noexcept;

/// What determines a contact's curve; all above 0.
struct ContactCurve {
  ContactLaw law = ContactLaw::kSharpSlip;
  double stiffness_n_per_m = 0.0;                                       ///< k
  double slip_force_n = 0.0;                                            ///< S
  double instrument_n_per_m = std::numeric_limits<double>::infinity();  ///< k_i

  [[nodiscard]] double presliding_m() const noexcept {
    return slip_force_n / stiffness_n_per_m;
  }
  /// u at which the contact slides as a whole [m].
  [[nodiscard]] double slides_at_m() const noexcept;
};

/// g(u) and its derivatives.
struct CurveShare {
  double value = 0.0;        ///< [-] [0, 1]
  double by_u = 0.0;         ///< [1/m]
  double by_log_k = 0.0;     ///< [-]
  double by_log_slip = 0.0;  ///< [-] by ln S
};

/// @param u_m [m] >= 0 of contact and instrument.
[[nodiscard]] CurveShare force_share(const ContactCurve& curve, double u_m) noexcept;

/// [J] lost in a closed loop of amplitude X [m] >= 0 (half the way from turn to turn).
[[nodiscard]] double loop_loss_j(const ContactCurve& curve,
                                 double amplitude_m) noexcept;

}  // namespace palpate
