// Length, variance and nugget of a surface field, from the data themselves.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "fitting/surface/gaussian_field.h"

namespace palpate {

/// Parameters that the data allow, by their probability.
struct ProbableParameters {
  FieldParameters parameters;
  double weight = 1.0;  ///< [-] sum 1 over all
};

struct FieldParametersReport {
  FieldParameters parameters;                    ///< the most probable
  std::array<FieldParameters, 2> of_smoothness;  ///< the most probable of each
  double log_likelihood = 0.0;                   ///< [-] mean over the sets of data
  int evaluations = 0;
  bool converged = false;
  std::vector<std::string> at_bound;  ///< "length lower bound", ...
  double seconds = 0.0;               ///< [s] wall time
};

/// Most probable parameters of several sets of data at the same points: one set of data
/// per depth. All depths have one set of parameters, so that the depths are smoothed
/// alike. The sets come from the same presses and err together: their log marginal
/// likelihoods are averaged, not added. Prior (Fuglstad et al. 2019): of 20 lengths one
/// is below a twentieth of the body's diagonal, density as 1 / length^2 far above. sd
/// and nugget are exponential, one of 20 above 2 and 0.3. By a downhill simplex in the
/// parameters' logarithms from the best of three lengths, for both smoothnesses.
/// Bounds: length from one mean edge to twice the body's diagonal (smoothness 2: at
/// most 68 mean edges). Bounds of sd are 1e-3 to 10, of the nugget 1e-4 to 3.
/// @param near if given, where to start instead.
/// @throws InputError for no data, or as FieldModel does.
[[nodiscard]] FieldParametersReport fit_field_parameters(
    const FieldModel& model, std::span<const FieldData> data,
    const FieldParameters* near = nullptr);

/// Parameters around the most probable ones of both smoothnesses, at most 14 (weights
/// below 0.01 left out). An average over them accounts for how little a few probes
/// state of length, sd and nugget. @param data, report of the fit.
[[nodiscard]] std::vector<ProbableParameters> probable_parameters(
    const FieldModel& model, std::span<const FieldData> data,
    const FieldParametersReport& report);

/// FieldModel::posterior() averaged over probable parameters: variances are their mean
/// and the spread of the means.
[[nodiscard]] FieldPosterior mixed_posterior(
    const FieldModel& model, std::span<const ProbableParameters> probable,
    const FieldData& data);

}  // namespace palpate
