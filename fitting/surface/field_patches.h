// How a field predicts patches of the surface that it has not seen. Everything is done
// again without these patches, so that nothing of what is predicted is in the
// prediction.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fitting/surface/field_parameters.h"
#include "fitting/surface/gaussian_field.h"

namespace palpate {

/// Points in patches of neighbours: seeds as far from each other as can be, each point
/// with its nearest seed. @param count of patches, at most as many as points.
[[nodiscard]] std::vector<std::vector<std::size_t>> patches_of(const FieldModel& model,
                                                               std::size_t count);

/// Points a patch should have, and how many patches there are at most.
constexpr std::size_t kPatchPoints = 3, kPatchesMax = 10;

struct PatchScore {
  std::size_t patches = 0;
  std::size_t points = 0;  ///< predicted, of one set
  double rms = 0.0;        ///< [-] predicted against measured, of all sets
  double coverage = 0.0;   ///< [-] share within 95 % intervals, of all sets
};

/// Leaves out each patch in turn, screens and fits the others, and predicts what was
/// measured there, noise and nugget included. Every finite value counts, also of points
/// that screening would have taken out: an interval that misses them has missed.
/// @param near parameters from which the fits start. NaN for fewer than two patches.
[[nodiscard]] PatchScore left_out_patches(const FieldModel& model,
                                          std::span<const FieldData> data,
                                          const FieldParameters& near);

}  // namespace palpate
