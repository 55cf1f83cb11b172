// The least-squares problem behind a family's fit, in scaled parameters.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "fitting/curve/curve_family.h"

namespace palpate {

/// Order of the shared parameters; the family's follow.
enum FamilyShared { kFamilyForce, kFamilySlope, kFamilyContact, kFamilyShared };

/// Samples in units of the depth and force range; x = 0 where the power law has its
/// contact point.
struct FamilyData {
  Eigen::VectorXd x, f;    ///< (n) [-]
  Eigen::VectorXd weight;  ///< (n) [-] of the residuals, (0, 1]
  double contact_min = 0.0;
  bool contact_held = false;  ///< the contact point is assumed, and so is no drift
  bool flat = false;          ///< no drift
  double baseline_force = 0.0, baseline_slope = 0.0;  ///< the power law's
  double x_origin_m = 0.0, length_m = 1.0, force_n = 1.0;
};

struct FamilySolution {
  std::shared_ptr<const CurveFamily> family;
  Eigen::VectorXd q;              ///< (3 + p) scaled
  Eigen::MatrixXd covariance;     ///< (3 + p) squared; NaN: cannot be separated
  std::vector<std::string> held;  ///< (3 + p) why a parameter was not free, or empty
  int free_parameters = 0;
  bool converged = false;
  int iterations = 0;
};

/// Whether the family's start has a shape that tells where it is.
[[nodiscard]] bool has_contact_of_its_own(std::string_view family);

/// @param contact where to start from, or where it is held unless `contact_free`.
/// @param warm parameters to start from, instead of the family's own starts.
[[nodiscard]] FamilySolution solve_family(const FamilyData& data,
                                          std::string_view family, double contact,
                                          bool contact_free,
                                          const Eigen::VectorXd* warm = nullptr);

/// b0 + b1 x + f(x - x0; q)
[[nodiscard]] double scaled_force(const CurveFamily& family, const Eigen::VectorXd& q,
                                  double x);

/// Its derivative by all parameters (3 + p).
[[nodiscard]] Eigen::VectorXd scaled_gradient(const CurveFamily& family,
                                              const Eigen::VectorXd& q, double x);

}  // namespace palpate
