// Length, variance and nugget of a surface field, from the data themselves.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "fitting/surface/gaussian_field.h"

namespace palpate {

struct FieldParametersReport {
  FieldParameters parameters;
  double log_likelihood = 0.0;  ///< summed over the sets of data
  int evaluations = 0;
  bool converged = false;
  std::vector<std::string> at_bound;  ///< "length lower bound", ...
  double seconds = 0.0;               ///< [s] wall time
};

/// Largest sum of log marginal likelihoods over several sets of data at the same points
/// (one per depth: one set of parameters for all, so that the depths are smoothed
/// alike), by a downhill simplex in the parameters' logarithms from the best of three
/// lengths, for both smoothnesses. Bounds: length from one mean edge to twice the
/// body's diagonal (smoothness 2: at most 68 mean edges), sd 1e-3 to 10, nugget 1e-4
/// to 3.
/// @param near if given, where to start instead.
/// @throws InputError for no data, or as FieldModel does.
[[nodiscard]] FieldParametersReport fit_field_parameters(
    const FieldModel& model, std::span<const FieldData> data,
    const FieldParameters* near = nullptr);

}  // namespace palpate
