// Points that are one but for rounding.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace palpate {

/// What single precision leaves open [points' unit]: four of its steps at the largest
/// coordinate. Exporters that compute a shared corner twice differ by so much.
[[nodiscard]] double rounding_of(const std::vector<Eigen::Vector3d>& points);

/// (n_points) the first point, in their order, that lies within `tolerance` of each in
/// every coordinate; itself if there is none. One that was given an earlier point takes
/// no others with it.
[[nodiscard]] std::vector<std::size_t> first_within(
    const std::vector<Eigen::Vector3d>& points, double tolerance);

}  // namespace palpate
