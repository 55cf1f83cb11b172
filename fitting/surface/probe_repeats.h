// Presses at one place, joined: what differs between them is repeatability, what
// differs between places beyond it is the surface's own roughness.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fitting/surface/gaussian_field.h"

namespace palpate {

/// [-] of the body's diagonal: places are the same within it.
inline constexpr double kSamePlace = 1e-6;

/// Presses of one place, by index, places in the order of their first press.
/// @param position_m of all presses. @param apart_m the same place within it.
[[nodiscard]] std::vector<std::vector<std::size_t>> places_of(
    std::span<const Eigen::Vector3d> position_m, double apart_m);

struct JoinedPresses {
  std::vector<FieldData> data;        ///< one datum a place, sets as given
  std::vector<double> repeatability;  ///< [-] by set; NaN where nothing tells it
  std::vector<std::size_t> left_out;  ///< presses far from the others of their place
};

/// Degrees of freedom within places that tell a repeatability.
constexpr std::size_t kRepeatsMin = 5;

/// By set: repeatability^2 = what robust spread of presses about their place's median
/// is beyond their stated errors. A press more than 4.5 standard deviations from the
/// median of three or more is left out, in all sets. A place's datum is the mean of the
/// others, weighed by 1 / (error^2 + repeatability^2), with the error that follows. So
/// a nugget fitted to joined data is roughness where the repeatability is known. Where
/// it is not, the nugget is both.
[[nodiscard]] JoinedPresses join_presses(
    std::span<const FieldData> data,
    const std::vector<std::vector<std::size_t>>& places);

}  // namespace palpate
