// Which probes of a surface do not belong to the field that all others agree on.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fitting/surface/field_parameters.h"
#include "fitting/surface/gaussian_field.h"

namespace palpate {

struct BadProbe {
  std::size_t point = 0;  ///< index among the model's points
  std::size_t set = 0;    ///< the set of data where it stands out most
  double value = 0.0;     ///< [-] there
  double expected = 0.0;  ///< [-] from all others
  double score = 0.0;     ///< [-] distance in standard deviations of the prediction
};

struct ScreenedField {
  std::vector<FieldData> data;         ///< as given, bad probes not used in any set
  std::vector<BadProbe> bad;           ///< worst first
  std::vector<std::size_t> undecided;  ///< beyond the limit of a fifth; kept
  FieldParametersReport parameters;    ///< of the data that are left
};

constexpr double kBadProbeScore = 4.5;  ///< 7e-6 of normal residuals are beyond

/// Suspects come first, without a model, since a few glitches would spoil the
/// likelihood. Suspects are probes farther than 4 robust standard deviations from the
/// median of their 8 nearest others. Parameters are then fitted to the others. Suspects
/// that the field predicts within kBadProbeScore come back. Of the rest the worst goes,
/// one at a time, while its left-out residual in any set is beyond kBadProbeScore. At
/// most a fifth of the probes are taken. Parameters are fitted anew whenever probes
/// came back or went.
/// @param data one set or more; all used at first where their values are finite.
/// @param near if given, parameters from which the fits start.
/// @throws InputError as FieldModel does.
[[nodiscard]] ScreenedField screen_probes(const FieldModel& model,
                                          std::span<const FieldData> data,
                                          const FieldParameters* near = nullptr);

}  // namespace palpate
