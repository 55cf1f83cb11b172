// The least-squares problem of one run of a lateral test under one law of contact.
//
//   q_i = S n_i p_i + b + c t_i
//
// Symbols: q_i measured force [N], S force while all slides at the mean normal force
// [N], n_i normal force over its mean, p_i of friction_history.h. b is the offset [N],
// t_i the clock from 0 to 1, c the drift [N]. Presliding length and the shape of the
// curve do not depend on n_i. The stiffness is in proportion to the normal force, as
// the runtime's is.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "fitting/lateral/contact_law.h"
#include "fitting/lateral/friction_history.h"
#include "fitting/lateral/lateral_path.h"

namespace palpate {

/// Places of a loop's parameters: ln k, ln S, a over the travel, b over the range of
/// forces, c over the range of forces.
enum LoopParameter : Eigen::Index { kLogStiffness, kLogSlip, kZero, kOffset, kDrift };
constexpr Eigen::Index kLoopParameters = 5;

/// What of a run tells its parameters.
struct LoopSamples {
  std::size_t sticks = 0;     ///< between rest and sliding
  std::size_t slides_up = 0;  ///< slide as a whole, to larger displacements
  std::size_t slides_down = 0;
  std::size_t motions = 0;  ///< from rest or a turn on, that end sliding
  [[nodiscard]] std::size_t slides() const { return slides_up + slides_down; }
};

struct SolvedLoop {
  ContactLaw law = ContactLaw::kSharpSlip;
  double instrument_n_per_m = std::numeric_limits<double>::infinity();
  double range_n = 0.0;        ///< [N] of the forces: unit of residuals
  Eigen::VectorXd q;           ///< (kLoopParameters)
  std::vector<bool> held;      ///< (kLoopParameters) not determined by the samples
  Eigen::VectorXd residual;    ///< (fitted) [-] modelled less measured, over range_n
  Eigen::MatrixXd covariance;  ///< (p x p), zero for held ones; NaN: not separated
  LoopSamples samples;
  bool slides = false;  ///< beyond the noise; else S is no more than a lower bound
  bool converged = false;
  bool endless = false;           ///< k is at a bound: no sample tells it
  double stiffest_n_per_m = 0.0;  ///< least stiffness at which no sample would stick

  [[nodiscard]] ContactCurve curve() const { return curve(q); }
  [[nodiscard]] ContactCurve curve(const Eigen::VectorXd& at) const;
  [[nodiscard]] double zero_m(const LateralPath& path,
                              const Eigen::VectorXd& at) const {
    return at[kZero] * path.travel_m;
  }
};

constexpr std::size_t kLoopPartMin = 5;  ///< samples that tell a stiffness or a force
constexpr double kSlidesShare = 0.95;    ///< [-] of the way until all slides
constexpr double kSlipDeviance = 20.0;   ///< -2 log likelihood by which slip is seen

/// States of the contact at all samples of a path.
[[nodiscard]] std::vector<FrictionState> states_along(const LateralPath& path,
                                                      const ContactCurve& curve,
                                                      double zero_m);

/// @param instrument_n_per_m of the instrument in series, infinite: rigid.
[[nodiscard]] SolvedLoop solve_loop(const LateralPath& path, ContactLaw law,
                                    double instrument_n_per_m);

}  // namespace palpate
