// One measured and fitted indentation of a body, and what it says at a depth.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "fitting/curve/family_fit.h"
#include "fitting/curve/measured_approach.h"
#include "fitting/curve/power_law_fit.h"
#include "fitting/curve/time_effects.h"

namespace palpate {

struct SurfaceProbe {
  std::string name;  ///< for lists, e.g. its file
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  /// [-] of the force on the tool, outward; zero: the surface's normal
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  Measurement measurement;
  Approach approach;
  ContactFit fit;
  std::optional<FamilyFit> curve =
      {};  ///< the chosen law; without, the power law's fit
  std::optional<Relaxation> relaxation = {};  ///< of its hold, where that was fitted
};

/// Why a probe says nothing of a depth. Reasons are an empty run, no convergence, a run
/// already in contact, or a contact point not known to a tenth of the depth. Empty
/// where there is no reason.
[[nodiscard]] std::string reason_unusable(const SurfaceProbe& probe);

/// Largest depth [m] beyond the contact point of its law.
[[nodiscard]] double depth_max_m(const SurfaceProbe& probe);

struct LogForces {
  Eigen::VectorXd value;  ///< (k) [-] log of force over 1 N; -inf where there is none
  Eigen::VectorXd sd;     ///< (k) [-] log_force_errors()
};

/// Of a usable probe, at depths d [m] (k), d > 0.
[[nodiscard]] LogForces log_forces(const SurfaceProbe& probe,
                                   const Eigen::VectorXd& depth_m);

/// "power-law" or the name of the chosen family.
[[nodiscard]] std::string law_of(const SurfaceProbe& probe);

}  // namespace palpate
