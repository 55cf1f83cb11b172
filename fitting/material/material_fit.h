// Material parameters from measured curves, by comparison with a response sweep; and
// whether the curves can tell them at all.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fitting/curve/measured_approach.h"
#include "formats/measurement/response_sweep.h"

namespace palpate {

/// A measured approach at one of the sweep's vertices.
struct MaterialCurve {
  Approach approach;
  std::size_t place = 0;         ///< of the vertex in the sweep
  double contact_point_m = 0.0;  ///< [m] where the search starts
};

/// Minimum over all else of the misfit at a value of one parameter.
struct ProfilePoint {
  double value = 0.0;
  double deviance = 0.0;  ///< [-] 2 log likelihood ratio to the best; 3.84 is 95 %
  bool other_at_bound = false;  ///< another parameter sits at the sweep's edge
};

struct MaterialParameter {
  std::string name;  ///< as in the sweep, with its unit
  double value = std::numeric_limits<double>::quiet_NaN();
  double sd_log = std::numeric_limits<double>::quiet_NaN();  ///< [-] of its logarithm
  /// 95 % interval by profile likelihood, within the sweep
  double low = 0.0, high = 0.0;
  bool identifiable = false;
  std::string why_not = {};  ///< one line
  std::vector<ProfilePoint> profile = {};
};

struct MaterialFit {
  std::vector<MaterialParameter> parameter;
  Eigen::MatrixXd correlation;          ///< (p x p) of the logarithms; NaN: unknown
  std::vector<double> contact_point_m;  ///< per curve [m]
  std::vector<double> rms_n;            ///< per curve [N]
  bool converged = false;
  int iterations = 0;
  double seconds = 0.0;
};

/// Least squares (Ceres) of b + f(parameters, x - x0) over all curves at once. f is the
/// sweep's force interpolated in logarithms, b and x0 of each curve are free.
/// Parameters stay within the sweep; the fit has several starts. A factor on all the
/// sweep's forces is free too, expected at 1 within the sweep's own error: a modulus is
/// known no better. Residuals of a curve count in units of their own rms, fewer where
/// neighbours err together (correlated_noise.h). Profiles: each parameter held at
/// values across the sweep, all else free.
///
/// A parameter is identifiable if its profile rises above 3.84 on both sides inside the
/// sweep. No other parameter may be at the sweep's edge there: else the interval is the
/// sweep's, not the data's.
/// @throws InputError for no curves, or curves that go deeper than twice the sweep.
[[nodiscard]] MaterialFit fit_material(const ResponseSweep& sweep,
                                       std::span<const MaterialCurve> curves);

}  // namespace palpate
